//! JSON: as much of it as requests and responses need.

use std::fmt::Write;

/// How deep arrays and objects may be nested. A request has five levels, a transition table one more.
const MAX_DEPTH: usize = 16;

/// A JSON value.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Json {
    Null,
    Bool(bool),
    Number(f64),
    Text(String),
    Array(Vec<Json>),
    Object(Vec<(String, Json)>),
}

impl Json {
    /// Parses a text that holds one value. `None` if it is not JSON.
    pub(crate) fn parse(text: &[u8]) -> Option<Self> {
        let mut parser = Parser { text: std::str::from_utf8(text).ok()?, at: 0 };
        let value = parser.value(0)?;
        parser.skip_space();
        (parser.at == parser.text.len()).then_some(value)
    }

    /// The member of an object.
    pub(crate) fn get(&self, name: &str) -> Option<&Json> {
        match self {
            Self::Object(members) => members.iter().find(|(known, _)| known == name).map(|(_, value)| value),
            _ => None,
        }
    }

    pub(crate) fn array(&self) -> Option<&[Json]> {
        if let Self::Array(values) = self { Some(values) } else { None }
    }

    pub(crate) fn text(&self) -> Option<&str> {
        if let Self::Text(text) = self { Some(text) } else { None }
    }

    /// A finite number.
    pub(crate) fn number(&self) -> Option<f64> {
        if let &Self::Number(number) = self { Some(number).filter(|number| number.is_finite()) } else { None }
    }

    /// A number without a fraction, from 0 to `most`.
    pub(crate) fn integer(&self, most: u32) -> Option<u32> {
        self.number()
            .filter(|number| number.fract() == 0.0 && (0.0..=f64::from(most)).contains(number))
            .map(|n| n as u32)
    }

    /// The value as a message shows it, shortened.
    pub(crate) fn shown(&self) -> String {
        match self {
            Self::Null => "null".into(),
            Self::Bool(value) => value.to_string(),
            Self::Number(number) => number.to_string(),
            Self::Text(text) => format!("'{}'", text.chars().take(40).collect::<String>()),
            Self::Array(values) => format!("an array of {}", values.len()),
            Self::Object(_) => "an object".into(),
        }
    }
}

struct Parser<'a> {
    text: &'a str,
    at: usize,
}

impl Parser<'_> {
    fn rest(&self) -> &str {
        &self.text[self.at..]
    }

    fn next_letter(&mut self) -> Option<char> {
        let letter = self.rest().chars().next()?;
        self.at += letter.len_utf8();
        Some(letter)
    }

    fn skip_space(&mut self) {
        self.at = self.text.len() - self.rest().trim_start_matches([' ', '\t', '\n', '\r']).len();
    }

    /// Whether the text goes on with a token, which is then consumed.
    fn take(&mut self, token: &str) -> bool {
        self.skip_space();
        let found = self.rest().starts_with(token);
        if found {
            self.at += token.len();
        }
        found
    }

    fn value(&mut self, depth: usize) -> Option<Json> {
        if depth > MAX_DEPTH {
            return None;
        }
        if self.take("[") {
            return self.array(depth);
        }
        if self.take("{") {
            return self.object(depth);
        }
        if self.take("\"") {
            return self.string().map(Json::Text);
        }
        for (token, value) in [("null", Json::Null), ("true", Json::Bool(true)), ("false", Json::Bool(false))] {
            if self.take(token) {
                return Some(value);
            }
        }
        let is_number = |letter: char| letter.is_ascii_digit() || ".+-eE".contains(letter);
        let end = self.rest().find(|letter| !is_number(letter)).unwrap_or(self.rest().len());
        let number = self.rest()[..end].parse().ok()?;
        self.at += end;
        Some(Json::Number(number))
    }

    fn array(&mut self, depth: usize) -> Option<Json> {
        let mut values = Vec::new();
        if self.take("]") {
            return Some(Json::Array(values));
        }
        loop {
            values.push(self.value(depth + 1)?);
            if self.take("]") {
                return Some(Json::Array(values));
            }
            self.take(",").then_some(())?;
        }
    }

    fn object(&mut self, depth: usize) -> Option<Json> {
        let mut members = Vec::new();
        if self.take("}") {
            return Some(Json::Object(members));
        }
        loop {
            self.take("\"").then_some(())?;
            let name = self.string()?;
            self.take(":").then_some(())?;
            members.push((name, self.value(depth + 1)?));
            if self.take("}") {
                return Some(Json::Object(members));
            }
            self.take(",").then_some(())?;
        }
    }

    /// The rest of a string, after its opening quote.
    fn string(&mut self) -> Option<String> {
        let mut string = String::new();
        loop {
            let letter = self.next_letter()?;
            match letter {
                '"' => return Some(string),
                '\\' => {
                    let escaped = self.next_letter()?;
                    string.push(match escaped {
                        'n' => '\n',
                        't' => '\t',
                        'r' => '\r',
                        'b' => '\u{8}',
                        'f' => '\u{c}',
                        'u' => self.unicode()?,
                        '"' | '\\' | '/' => escaped,
                        _ => return None,
                    });
                }
                letter => string.push(letter),
            }
        }
    }

    /// The four digits of `\u`. Halves of pairs, which no name here needs, become the replacement character.
    fn unicode(&mut self) -> Option<char> {
        let code = u32::from_str_radix(self.rest().get(..4)?, 16).ok()?;
        self.at += 4;
        Some(char::from_u32(code).unwrap_or(char::REPLACEMENT_CHARACTER))
    }
}

/// Appends a text as a JSON string.
pub(crate) fn write_text(out: &mut String, text: &str) {
    out.push('"');
    for letter in text.chars() {
        match letter {
            '"' | '\\' => out.extend(['\\', letter]),
            letter if letter < ' ' => {
                let _ = write!(out, "\\u{:04x}", letter as u32);
            }
            letter => out.push(letter),
        }
    }
    out.push('"');
}

/// Appends a number, or null for those that JSON does not have.
pub(crate) fn write_number(out: &mut String, number: f64) {
    if number.is_finite() {
        let _ = write!(out, "{number}");
    } else {
        out.push_str("null");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_parsed() {
        let parsed = Json::parse(br#" {"a": [1, -2.5e1, "x\n\u00e9"], "b": {"c": null, "d": true}} "#).expect("JSON");
        assert_eq!(parsed.get("a").and_then(Json::array).map(<[Json]>::len), Some(3));
        assert_eq!(parsed.get("a").and_then(Json::array).and_then(|a| a[1].number()), Some(-25.0));
        assert_eq!(parsed.get("a").and_then(Json::array).and_then(|a| a[2].text()), Some("x\n\u{e9}"));
        assert_eq!(parsed.get("b").and_then(|b| b.get("d")), Some(&Json::Bool(true)));
    }

    #[test]
    fn what_is_not_json_is_refused() {
        for text in ["", "[", "[1,]", "{\"a\"}", "nul", "1 2", "\"", "\"\\u12", "\"\\x\"", "--1", "{\"a\":1,}", "[1 2]"]
        {
            assert_eq!(Json::parse(text.as_bytes()), None, "{text}");
        }
        assert_eq!(Json::parse("[".repeat(100_000).as_bytes()), None);
        assert_eq!(Json::parse(&[0xff]), None);
        assert_eq!(Json::parse(b"1e999").and_then(|number| number.number()), None);
    }

    #[test]
    fn texts_are_written_so_that_they_are_read_again() {
        for text in ["", "a\"b\\c\n", "\u{1}é"] {
            let mut written = String::new();
            write_text(&mut written, text);
            assert_eq!(Json::parse(written.as_bytes()), Some(Json::Text(text.into())));
        }
    }
}
