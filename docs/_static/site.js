/* A button that copies each block of code, but for what programs print; on a phone, tables that are too wide become lists of rows. */
"use strict";

function copy(text) {
  if (navigator.clipboard) return navigator.clipboard.writeText(text);
  const area = document.body.appendChild(document.createElement("textarea")); // pages without https have no clipboard
  area.value = text;
  area.select();
  document.execCommand("copy");
  area.remove();
  return Promise.resolve();
}

/* What to copy: of a session of Python, the lines typed, without their prompts. */
function program(block) {
  if (!block.querySelector(".gp")) return block.textContent;
  const typed = block.textContent.split("\n").filter((line) => /^(>>>|\.\.\.)( |$)/.test(line));
  return typed.map((line) => `${line.slice(4)}\n`).join("");
}

for (const block of document.querySelectorAll("div:not(.highlight-output) > div.highlight > pre")) {
  const button = document.createElement("button");
  button.className = "copy";
  button.type = "button";
  button.textContent = "Copy";
  button.addEventListener("click", async () => {
    button.textContent = await copy(program(block)).then(() => "Copied", () => "Not copied");
    button.classList.add("copied");
    setTimeout(() => { button.textContent = "Copy"; button.classList.remove("copied"); }, 1500);
  });
  block.parentElement.append(button);
}

/* Without this, such a table scrolls within itself. */
const PHONE = window.matchMedia("(max-width: 46em)");
const TABLES = [...document.querySelectorAll("article table.docutils")].filter((table) => table.tHead && !table.querySelector("img, [colspan], [rowspan]"));

for (const table of TABLES) {
  const heads = [...table.tHead.rows[0].cells].map((cell) => cell.textContent.trim());
  for (const row of table.tBodies[0].rows) {
    [...row.cells].forEach((cell, column) => { cell.dataset.label = heads[column] ?? ""; });
  }
}

function stack() {
  for (const table of TABLES) {
    table.classList.remove("stacked");
    table.classList.toggle("stacked", PHONE.matches && table.scrollWidth > table.parentElement.clientWidth);
  }
}

stack();
window.addEventListener("resize", stack);
