"""Style and behaviour of the report page; both stand inside it, so that it asks nothing of any network."""

from __future__ import annotations

__all__ = ["POLICY", "SCRIPT", "STYLE", "html_page"]

POLICY = "default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'"
"""What the page may load: nothing."""

STYLE = """
:root { color-scheme: light dark; --ink: #1c1c1c; --dim: #5c5c5c; --paper: #ffffff; --shade: #f3f3f1; --line: #d5d5d0;
  --link: #0b4ea2; --good: #17703a; --bad: #a8071a; --none: #7a5200; }
@media (prefers-color-scheme: dark) { :root { --ink: #e6e6e3; --dim: #a3a39d; --paper: #191a1b; --shade: #242628;
  --line: #3b3e41; --link: #8ab4f0; --good: #6fcf8f; --bad: #ff8b8b; --none: #e2b45a; } }
* { box-sizing: border-box; }
body { margin: 0 auto; max-width: 76rem; padding: 1.5rem; color: var(--ink); background: var(--paper);
  font: 16px/1.5 system-ui, sans-serif; }
h1 { font-size: 1.7rem; line-height: 1.25; margin: 0 0 .3rem; } h2 { margin: 3rem 0 .3rem; font-size: 1.35rem;
  border-top: 1px solid var(--line); padding-top: 1.5rem; } h3 { margin: 1.6rem 0 .5rem; font-size: 1.05rem; }
p { margin: .3rem 0 .8rem; } .dim { color: var(--dim); } a { color: var(--link); }
nav ol { columns: 2; padding-left: 1.4rem; } nav .dim { font-size: .9rem; }
code { font: .88em ui-monospace, monospace; } .key { overflow-wrap: anywhere; }
.scroll { overflow: auto; max-height: 30rem; border: 1px solid var(--line); border-radius: 4px; }
table { border-collapse: collapse; font-size: .85rem; width: 100%; font-variant-numeric: tabular-nums; }
th, td { text-align: left; padding: .25rem .6rem; border-bottom: 1px solid var(--line); vertical-align: top; }
th { position: sticky; top: 0; background: var(--shade); white-space: nowrap; }
th button { all: unset; cursor: pointer; font-weight: 600; } th button:focus-visible { outline: 2px solid var(--link); }
th small { font-weight: 400; color: var(--dim); } td.number { text-align: right; white-space: nowrap; }
.reproduced, .agree { color: var(--good); } .differs, .disagree { color: var(--bad); }
.not_reproducible, .undecidable, .pattern_only { color: var(--none); }
td.verdict { font-weight: 600; white-space: nowrap; } td.wide { min-width: 16rem; }
details { margin: .5rem 0; } summary { cursor: pointer; padding: .2rem 0; }
figure { margin: 1rem 0 1.5rem; border: 1px solid var(--line); border-radius: 4px; overflow: hidden; }
.frame { height: min(78vh, 46rem); overflow: hidden; background: #ffffff; cursor: grab; touch-action: none;
  position: relative; } .frame:active { cursor: grabbing; }
.frame:focus-visible { outline: 3px solid var(--link); outline-offset: -3px; }
.frame img { position: absolute; left: 0; top: 0; user-select: none; -webkit-user-drag: none; }
figcaption { display: flex; gap: .5rem; align-items: center; padding: .4rem .7rem; background: var(--shade);
  font-size: .9rem; } figcaption span { flex: 1; }
.tool { font: inherit; font-size: .85rem; color: var(--ink); background: var(--paper); border: 1px solid var(--line);
  border-radius: 4px; padding: .1rem .6rem; cursor: pointer; } .tool:hover { border-color: var(--link); }
.tools { display: flex; gap: .5rem; align-items: center; flex-wrap: wrap; margin: .4rem 0; }
.tools input { font: inherit; font-size: .85rem; padding: .15rem .5rem; color: var(--ink); background: var(--paper);
  border: 1px solid var(--line); border-radius: 4px; } .cards { display: flex; flex-wrap: wrap; gap: 1rem 2.2rem; }
.cards b { display: block; font-size: 1.25rem; }
@media print { .tool, .tools, nav { display: none; } .frame { height: auto; } .frame img { position: static;
  width: 100% !important; height: auto !important; } details { display: block; } .scroll { max-height: none; } }
"""

SCRIPT = """
'use strict';
for (const figure of document.querySelectorAll('figure')) {
  const frame = figure.querySelector('.frame'), image = frame.querySelector('img');
  const ratio = Number(image.dataset.ratio);
  let scale = 1, x = 0, y = 0, held = null;
  const fit = () => {
    const width = Math.min(frame.clientWidth, frame.clientHeight * ratio);
    return [width, width / ratio];
  };
  const draw = () => {
    const [width, height] = fit();
    image.style.width = width * scale + 'px';
    image.style.height = height * scale + 'px';
    image.style.left = (frame.clientWidth - width * scale) / 2 + x + 'px';
    image.style.top = (frame.clientHeight - height * scale) / 2 + y + 'px';
    figure.dataset.scale = scale.toFixed(3);
  };
  const zoom = (factor, at) => {
    const next = Math.min(40, Math.max(1, scale * factor)), done = next / scale;
    const box = frame.getBoundingClientRect();
    const px = at ? at.clientX - box.left - frame.clientWidth / 2 : 0;
    const py = at ? at.clientY - box.top - frame.clientHeight / 2 : 0;
    x = px - (px - x) * done; y = py - (py - y) * done; scale = next;
    if (scale === 1) { x = 0; y = 0; }
    draw();
  };
  const acts = { in: () => zoom(1.5), out: () => zoom(1 / 1.5), reset: () => { scale = 1; x = 0; y = 0; draw(); } };
  for (const button of figure.querySelectorAll('button[data-act]'))
    button.addEventListener('click', () => acts[button.dataset.act]());
  frame.addEventListener('wheel', event => {
    if (!event.ctrlKey && document.activeElement !== frame) return;
    event.preventDefault(); zoom(Math.exp(-event.deltaY / 400), event);
  }, { passive: false });
  frame.addEventListener('dblclick', event => zoom(2, event));
  frame.addEventListener('pointerdown', event => { held = [event.clientX - x, event.clientY - y];
    frame.setPointerCapture(event.pointerId); frame.focus({ preventScroll: true }); });
  frame.addEventListener('pointermove', event => { if (held) { x = event.clientX - held[0]; y = event.clientY - held[1];
    draw(); } });
  frame.addEventListener('pointerup', () => { held = null; });
  frame.addEventListener('keydown', event => {
    const moves = { ArrowLeft: [60, 0], ArrowRight: [-60, 0], ArrowUp: [0, 60], ArrowDown: [0, -60] }[event.key];
    if (moves) { x += moves[0]; y += moves[1]; draw(); }
    else if (event.key === '+' || event.key === '=') acts.in();
    else if (event.key === '-') acts.out();
    else if (event.key === '0') acts.reset();
    else return;
    event.preventDefault();
  });
  new ResizeObserver(draw).observe(frame);
}
for (const table of document.querySelectorAll('table')) {
  const body = table.tBodies[0];
  table.querySelectorAll('th button').forEach((button, column) => button.addEventListener('click', () => {
    const up = button.parentElement.getAttribute('aria-sort') !== 'ascending';
    table.querySelectorAll('th').forEach(head => head.removeAttribute('aria-sort'));
    button.parentElement.setAttribute('aria-sort', up ? 'ascending' : 'descending');
    const value = row => row.cells[column].dataset.value ?? row.cells[column].textContent;
    const order = (a, b) => { const p = value(a), q = value(b), m = Number(p), n = Number(q);
      return p !== '' && q !== '' && !isNaN(m) && !isNaN(n) ? m - n : p.localeCompare(q); };
    body.append(...[...body.rows].sort((a, b) => up ? order(a, b) : order(b, a)));
  }));
  const tools = table.closest('section, details').querySelector('.tools[data-for="' + table.id + '"]');
  if (!tools) continue;
  tools.querySelector('input')?.addEventListener('input', event => {
    const words = event.target.value.toLowerCase();
    for (const row of body.rows) row.hidden = !row.textContent.toLowerCase().includes(words);
  });
  tools.querySelector('button[data-csv]')?.addEventListener('click', event => {
    const quote = text => /[",\\n]/.test(text) ? '"' + text.replaceAll('"', '""') + '"' : text;
    const lines = [[...table.tHead.rows[0].cells].map(head => quote(head.dataset.name))];
    for (const row of body.rows) if (!row.hidden)
      lines.push([...row.cells].map(cell => quote(cell.dataset.value ?? cell.textContent)));
    const link = document.createElement('a');
    link.href = URL.createObjectURL(new Blob([lines.map(line => line.join(',')).join('\\n') + '\\n']));
    link.download = event.target.dataset.csv; link.click(); URL.revokeObjectURL(link.href);
  });
}
for (const button of document.querySelectorAll('button[data-copy]'))
  button.addEventListener('click', () => navigator.clipboard.writeText(button.dataset.copy)
    .then(() => { button.textContent = 'copied'; }, () => { button.textContent = 'select and copy it'; }));
"""


def html_page(title: str, policy: str, style: str, body: str) -> str:
    """Return a whole page; title, policy and body are HTML, escaped where they have to be."""
    return (
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        f'<meta http-equiv="Content-Security-Policy" content="{policy}">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n<link rel="icon" href="data:,">\n'
        f"<title>{title}</title>\n<style>{style}</style>\n</head>\n<body>\n{body}\n</body>\n</html>\n"
    )
