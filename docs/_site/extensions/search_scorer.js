// The order of the search results; docs/_site/extensions/search_words.py has more about the search.
// A page whose title has the words of the query comes first; the list of changes and the like come last.
var Scorer = {
  score: ([page, title, _anchor, _description, score, _file, kind]) => {
    const query = new URLSearchParams(window.location.search).get("q") || "";
    const words = splitQuery(query.toLowerCase());
    const inTitle = words.filter((word) => title.toLowerCase().includes(word)).length;
    const bonus = kind === "object" || words.length === 0 ? 0 : (10 * inTitle) / words.length;
    const last = /^reference\/(changelog|contributing|security|versioning)$/.test(page);
    return score + bonus - (last ? 20 : 0);
  },
  // The values of Sphinx.
  objNameMatch: 11,
  objPartialMatch: 6,
  objPrio: { 0: 15, 1: 5, 2: -5 },
  objPrioDefault: 0,
  title: 15,
  partialTitle: 7,
  term: 5,
  partialTerm: 2,
};
