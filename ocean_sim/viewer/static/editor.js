// A scene as text: numbered lines, what is wrong at its line, and keys and words that the schema knows.
class Editor {
  constructor(box, send) {
    this.send = send;
    this.text = box.querySelector("textarea");
    this.lines = box.querySelector(".lines");
    this.list = box.querySelector(".problems");
    this.menu = box.querySelector(".menu");
    this.problems = [];
    this.schema = null;
    this.original = "";
    this.text.addEventListener("input", () => { this.number(); this.later(); this.complete(); });
    this.text.addEventListener("scroll", () => { this.lines.scrollTop = this.text.scrollTop; });
    this.text.addEventListener("keydown", (event) => this.key(event));
    this.text.addEventListener("blur", () => setTimeout(() => { this.menu.hidden = true; }, 150));
    const goes = (event) => {
      const row = event.target.closest("[data-line]");
      if (row) { event.preventDefault(); this.go(+row.dataset.line, +row.dataset.column); }
    };
    this.list.addEventListener("click", goes);
    this.list.addEventListener("keydown", (event) => { if (event.key === "Enter" || event.key === " ") goes(event); });
  }

  load(text) {
    this.text.value = this.original = text;
    this.show([]);
  }

  later() {
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.send({ do: "check", text: this.text.value }), 350);
  }

  number() {
    const wrong = new Set(this.problems.map((p) => p.line));
    this.lines.innerHTML = this.text.value.split("\n").map((row, k) =>
      `<div${wrong.has(k + 1) ? ' class="bad"' : ""} data-row="${escaped(row)}"><b>${k + 1}</b></div>`).join("");
    this.lines.scrollTop = this.text.scrollTop;
  }

  show(problems) {
    this.problems = problems;
    this.number();
    this.list.innerHTML = problems.map((p) => `<li${p.line ? ` tabindex="0" data-line="${p.line}" data-column="${p.column || 1}"` : ""}>` +
      `<b>${p.line ? `line ${p.line}` : "scene"}</b> <code>${escaped(p.key)}</code> ${escaped(p.message)}</li>`).join("");
    this.text.setAttribute("aria-invalid", problems.length ? "true" : "false");
  }

  go(line, column) {
    const before = this.text.value.split("\n").slice(0, line - 1).reduce((n, row) => n + row.length + 1, 0);
    this.text.focus();
    this.text.setSelectionRange(before + column - 1, before + column - 1);
    this.text.scrollTop = this.lines.children[line - 1].offsetTop - 60;
  }

  key(event) {
    if (!this.menu.hidden) {
      const rows = [...this.menu.children], at = rows.findIndex((row) => row.classList.contains("on"));
      if (event.key === "ArrowDown" || event.key === "ArrowUp") {
        event.preventDefault();
        rows[at]?.classList.remove("on");
        const next = rows[(at + (event.key === "ArrowDown" ? 1 : rows.length - 1)) % rows.length];
        next.classList.add("on");
        next.scrollIntoView({ block: "nearest" });
        return;
      }
      if (event.key === "Enter" || event.key === "Tab") { event.preventDefault(); this.take(rows[at]?.dataset.word); return; }
      if (event.key === "Escape") { event.preventDefault(); event.stopPropagation(); this.menu.hidden = true; return; }
    }
    if (event.key === " " && event.ctrlKey) { event.preventDefault(); this.complete(true); }
  }

  insert(text) {
    const at = this.text.selectionStart;
    this.text.setRangeText(text, at, this.text.selectionEnd, "end");
    this.text.dispatchEvent(new Event("input"));
  }

  // The keys above a line, from their indentation.
  path(rows, at) {
    const found = [];
    let depth = rows[at].search(/\S|$/);
    for (let k = at - 1; k >= 0 && depth > 0; k--) {
      const match = /^(\s*)([A-Za-z_][\w]*):\s*(#.*)?$/.exec(rows[k]);
      if (match && match[1].length < depth) { found.unshift(match[2]); depth = match[1].length; }
    }
    return found;
  }

  // The parts of the schema that a place may be.
  at(path, text) {
    let nodes = [this.schema];
    for (const step of path) nodes = nodes.flatMap((node) => this.open(node)).flatMap((node) => {
      const inner = node.properties?.[step] || (typeof node.additionalProperties === "object" ? node.additionalProperties : null);
      return inner ? [inner] : [];
    });
    return nodes.flatMap((node) => this.open(node)).filter((node) => {
      const kind = node.properties?.kind?.const, written = path.length === 1 && new RegExp(`^${path[0]}:[^\\n]*(?:\\n[ \\t]+[^\\n]*)*?kind:\\s*(\\w+)`, "m").exec(text)?.[1];
      return !kind || !written || kind === written;
    });
  }

  open(node) {
    if (!node) return [];
    if (node.$ref) {
      const name = node.$ref.replace("#/$defs/", "");
      return this.open(this.schema.$defs[name]);
    }
    return node.anyOf || node.oneOf ? (node.anyOf || node.oneOf).flatMap((one) => this.open(one)) : [node];
  }

  complete(asked) {
    if (!this.schema) return;
    const upTo = this.text.value.slice(0, this.text.selectionStart), rows = upTo.split("\n"), row = rows[rows.length - 1];
    const value = /^(\s*)([A-Za-z_]\w*):\s+(\w*)$/.exec(row), inline = /[{,]\s*([A-Za-z_]\w*)?$/.exec(row), key = /^(\s*)(\w*)$/.exec(row);
    let words = [], begun = "";
    const path = this.path(rows, rows.length - 1);
    if (value) {
      begun = value[3];
      words = this.at([...path, value[2]], this.text.value).flatMap((node) => node.enum || (node.const ? [node.const] : node.type === "boolean" ? ["true", "false"] : []));
    } else if (inline && /^\s*[A-Za-z_]\w*:\s*\{/.test(row)) {
      begun = inline[1] || "";
      words = this.keysOf([...path, /^\s*([A-Za-z_]\w*):/.exec(row)[1]]);
    } else if (key && (key[2] || asked)) {
      begun = key[2];
      words = this.keysOf(path);
    }
    words = [...new Map(words.map((w) => [w.word || w, w])).values()].filter((w) => String(w.word || w).startsWith(begun) && (w.word || w) !== begun);
    if (!words.length || (!begun && !asked && !value && !inline)) { this.menu.hidden = true; return; }
    this.begun = begun;
    this.menu.innerHTML = words.slice(0, 60).map((w, k) => `<li data-word="${escaped(w.word ? `${w.word}: ` : w)}" class="${k ? "" : "on"}">` +
      `<b>${escaped(w.word || w)}</b> <span>${escaped(w.unit ? `[${w.unit}]` : "")} ${escaped(w.what || "")}</span></li>`).join("");
    for (const item of this.menu.children) item.onmousedown = (event) => { event.preventDefault(); this.take(item.dataset.word); };
    const { offsetTop, offsetHeight } = this.lines.children[rows.length - 1];
    this.menu.style.top = `${Math.min(offsetTop + offsetHeight - this.text.scrollTop, this.text.clientHeight - 40)}px`;
    this.menu.hidden = false;
  }

  keysOf(path) {
    return this.at(path, this.text.value).flatMap((node) => Object.entries(node.properties || {}).map(([word, inner]) => ({
      word, unit: inner.unit, what: inner.description,
    })));
  }

  take(word) {
    this.menu.hidden = true;
    if (word) this.insert(word.slice(this.begun.length));
  }
}
