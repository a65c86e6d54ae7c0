// Elements of the page.

/** A new element with its properties, attributes (`role` and the names with a hyphen) and children. */
export function make(tag, properties = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (name === "role" || name.includes("-")) element.setAttribute(name, value);
    else element[name] = value;
  }
  element.append(...children);
  return element;
}

/** Shows why a typed value was rejected, at its field and in the paragraph below; null removes the message. */
export function refuse(place, input, message) {
  place.hidden = !message;
  place.textContent = message ? `${message}. The previous value is kept.` : "";
  if (message) input.setAttribute("aria-invalid", "true");
  else input.removeAttribute("aria-invalid");
}

/** The place for such messages. */
export function refusalPlace(properties = {}) {
  return make("p", { className: "refused", hidden: true, role: "alert", ...properties });
}

const STEPS = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 };

/**
 * Adds radio buttons to a group, [value, ...content] each, that the arrow keys choose as well. The attribute
 * `data-<name>` of a button holds its value. Returns a function that marks the button of a value, and returns it.
 */
export function radioButtons(group, name, choices, choose) {
  const buttons = choices.map(([value, ...content]) =>
    make("button", { type: "button", role: "radio", [`data-${name}`]: value, onclick: () => choose(value) }, ...content),
  );
  group.append(...buttons);
  group.addEventListener("keydown", (event) => {
    const at = buttons.indexOf(document.activeElement);
    if (!(event.key in STEPS) || at < 0) return;
    event.preventDefault();
    const next = buttons[(at + STEPS[event.key] + buttons.length) % buttons.length];
    next.focus();
    next.click();
  });
  return (value) => {
    const chosen = buttons[choices.findIndex(([each]) => each === value)];
    for (const button of buttons) {
      button.setAttribute("aria-checked", button === chosen);
      button.tabIndex = button === chosen ? 0 : -1;
    }
    return chosen;
  };
}
