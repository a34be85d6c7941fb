// Excerpts in the results of the search: some 100 characters around the best hit, from texts.js, beside this file.
const EXCERPT_HALF = 55;  // characters before and after the beginning of a hit

// The paragraph with the place below `heading` in `text` that has most of the `words`; null if it has none.
function excerpt(text, heading, words) {
  const low = text.toLowerCase(), after = Math.max(0, text.indexOf(heading)) + heading.length;
  const hits = words.flatMap((word) => [...low.matchAll(new RegExp(`\\b${word}`, "g"))].map((hit) => ({ at: hit.index, word }))).filter((hit) => hit.at >= after);
  if (!hits.length) return null;
  for (const hit of hits) hit.count = new Set(hits.filter((one) => Math.abs(one.at - hit.at) < EXCERPT_HALF).map((one) => one.word)).size;
  const { at, word } = hits.sort((a, b) => b.count - a.count || a.at - b.at)[0], end = text.indexOf(" ", at + EXCERPT_HALF);
  const start = text.indexOf(" ", Math.max(after - 1, at - EXCERPT_HALF)) + 1, line = document.createElement("p"), mark = document.createElement("mark");
  mark.textContent = text.slice(at, at + word.length);
  line.append("… ", text.slice(Math.min(start, at), at), mark, text.slice(at + word.length, end < 0 ? undefined : end), " …");
  return line;
}

addEventListener("DOMContentLoaded", () => {
  const results = document.getElementById("search-results"), script = document.createElement("script");
  if (!results) return;
  script.src = "_static/texts.js";
  script.onload = () => {
    const asked = new URLSearchParams(location.search).get("q") ?? "", stemmer = new Stemmer();
    const words = (asked.toLowerCase().match(/[\p{L}\p{N}_]+/gu) ?? []).filter((word) => !stopwords.has(word));
    const stems = words.map((word) => word.startsWith(stemmer.stemWord(word)) ? stemmer.stemWord(word) : word);
    const show = () => {
      for (const link of results.querySelectorAll("li:not(:has(p)) > a")) {
        const line = excerpt(TEXTS[link.getAttribute("href").split(".html")[0]] ?? "", link.textContent.split(" > ").pop(), stems);
        if (line) link.parentNode.append(line);
      }
    };
    new MutationObserver(show).observe(results, { childList: true, subtree: true });
    show();
  };
  document.head.append(script);
});
