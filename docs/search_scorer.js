// The order of search results: pages for users, then names of the API, then pages about the making of the library.
// A function or class whose name is searched for comes first of all; 16 is the score of a whole name.
var Scorer = {
  score: ([page, title, , , score]) =>
    score + (score >= 16 && /^liehom(\.(base|exact|flow|studies))?\.\w+\.\w+$/.test(title) ? 100 : 0) + (/^(architecture|changelog|contributing|debugging|decisions|performance)/.test(page) ? -6 : page.startsWith("api/") ? 0 : 2),
  objNameMatch: 11,
  objPartialMatch: 6,
  objPrio: { 0: 5, 1: 5, 2: -5 },
  objPrioDefault: 0,
  title: 15,
  partialTitle: 7,
  term: 5,
  partialTerm: 2,
};
