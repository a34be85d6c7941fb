// Of every word that is seen: its contrast to all that lies behind it, with the sea both black and white there.
(() => {
  const colour = (text) => { const m = /rgba?\(([^)]+)\)/.exec(text); const v = m ? m[1].split(/[,\/ ]+/).map(Number) : [0, 0, 0, 0]; return [v[0], v[1], v[2], v[3] ?? 1]; };
  const over = (top, below) => below.map((b, k) => top[k] * top[3] + b * (1 - top[3]));
  const light = (c) => { const [r, g, b] = c.map((v) => { v /= 255; return v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4; }); return 0.2126 * r + 0.7152 * g + 0.0722 * b; };
  const ratio = (a, b) => { const [x, y] = [light(a), light(b)].sort((p, q) => q - p); return (x + 0.05) / (y + 0.05); };
  const found = [];
  for (const one of document.querySelectorAll("body *")) {
    const words = [...one.childNodes].filter((n) => n.nodeType === 3).map((n) => n.textContent.trim()).join(" ").trim() || (one.matches("input:not([type=range], [type=checkbox]), select, textarea") ? one.value || "value" : "");
    const box = one.getBoundingClientRect(), style = getComputedStyle(one);
    if (!words || !box.width || !box.height || style.visibility === "hidden" || one.closest(":disabled, script, style, .gone")) continue;
    let least = Infinity;
    for (const sea of [[0, 0, 0], [255, 255, 255]]) {
      const chain = [];
      for (let at = one; at; at = at.parentElement) { chain.unshift(colour(getComputedStyle(at).backgroundColor)); if (getComputedStyle(at).position === "fixed" && at.id !== "stage") break; }
      const back = chain.reduce((below, top) => over(top, below), sea);
      least = Math.min(least, ratio(over(colour(style.color), back), back));
    }
    const large = parseFloat(style.fontSize) >= 24 || (parseFloat(style.fontSize) >= 18.66 && +style.fontWeight >= 700);
    found.push({ words: words.slice(0, 40), id: one.id || one.className || one.tagName, least: +least.toFixed(2), large });
  }
  return found;
})()
