// The order of search results: pages for users, then names of the API, then pages about the making of the library.
var Scorer = {
  score: ([page, , , , score]) =>
    score + (/^(architecture|changelog|contributing|debugging|decisions|performance)/.test(page) ? -6 : page.startsWith("api/") ? 0 : 2),
  objNameMatch: 11,
  objPartialMatch: 6,
  objPrio: { 0: 5, 1: 5, 2: -5 },
  objPrioDefault: 0,
  title: 15,
  partialTitle: 7,
  term: 5,
  partialTerm: 2,
};
