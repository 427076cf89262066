/* A button at each block of code that copies it; of command lines it omits prompts and comments. */
"use strict";

function codeOf(block) {
  const lines = block.textContent.replace(/\n+$/, "").split("\n");
  const isShell = !/highlight-(?!none|sh|console|default)/.test(block.closest("[class*=highlight-]")?.className ?? "");
  return (isShell ? lines.map((line) => line.replace(/^\$ /, "").replace(/\s{2,}#.*$/, "")) : lines).join("\n") + "\n";
}

async function copy(text) {
  if (navigator.clipboard) return navigator.clipboard.writeText(text);
  const area = document.body.appendChild(document.createElement("textarea")); // a page that was opened from disk
  area.value = text;
  area.select();
  document.execCommand("copy");
  area.remove();
}

document.addEventListener("DOMContentLoaded", () => {
  for (const block of document.querySelectorAll("div.highlight > pre")) {
    const button = document.createElement("button");
    button.className = "copy";
    button.type = "button";
    button.textContent = "copy";
    button.addEventListener("click", async () => {
      await copy(codeOf(block));
      button.textContent = "copied";
      setTimeout(() => { button.textContent = "copy"; }, 1500);
    });
    block.parentElement.append(button);
  }
});
