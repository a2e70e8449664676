/* Order of search results, read before Sphinx's searchtools.js (conf.py: html_search_scorer).
 *
 * Keywords of keywords.toml have up to 100 points. Then come public functions by name, pages and sections with the query in their title, and
 * pages with it in their text. Names of other records and functions, decisions, changes and notes for developers come last.
 */
"use strict";

const QUERY = (new URLSearchParams(window.location.search).get("q") ?? "").toLowerCase().split(/[^\p{Letter}\p{Number}_]+/u);
const LAST = /^(adr\/|changelog|releases|mutants|contributing|architecture|performance)/;

/* seaglint.mean and its like: a function that `import seaglint as sg` gives. */
const isPublic = (name) => /^(seaglint|sg)\.[^.]+$/.test(name);

var Scorer = {
  score: ([docname, title, anchor, description, score, filename, kind]) => {
    if (kind === "object") return isPublic(title) ? score : score - 40;
    if (kind === "index") return score;
    if (LAST.test(docname)) return score - 30;
    if (docname.startsWith("api/") && !isPublic(title)) return score - 3;
    return QUERY.every((word) => title.toLowerCase().includes(word)) ? score + 10 : score;
  },
  objNameMatch: 40,
  objPartialMatch: 6,
  objPrio: { 0: 15, 1: 5, 2: -5 },
  objPrioDefault: 0,
  title: 30,
  partialTitle: 12,
  term: 5,
  partialTerm: 2,
};
