"""Style of the workbench: the colours of the viewer's other pages."""

from __future__ import annotations

from typing import Final

CSS: Final = """
:root { --ground: #15181b; --panel: #1d2125; --line: #343b41; --text: #dfe3e6; --faint: #98a2aa; --mark: #f0b54a; --wrong: #ff8a75;
  color-scheme: dark; }
body.bench { background: var(--ground); color: var(--text); font: 14px/1.4 system-ui, "DejaVu Sans", sans-serif; }
.bench .nicegui-content { padding: 0; }
.bench .whole { width: 100%; gap: 0; }
.bench .top { width: 100%; align-items: center; gap: 1rem; padding: .45rem .9rem; background: var(--panel);
  border-bottom: 1px solid var(--line); }
.bench .mark { color: var(--mark); font-weight: 700; letter-spacing: .03em; }
.bench .presets { width: 30rem; max-width: 60vw; }
.bench .faint { color: var(--faint); font-size: 12.5px; }
.bench .grow { flex: 1; min-width: 0; }
.bench .lines { white-space: pre-line; }
.bench .columns { width: 100%; display: grid; grid-template-columns: minmax(320px, 400px) minmax(0, 1fr); align-items: start; }
.bench .left { gap: 0; border-right: 1px solid var(--line); background: var(--panel); height: calc(100vh - 58px); overflow-y: auto;
  flex-wrap: nowrap; position: sticky; top: 0; }
.bench .right { gap: .8rem; padding: .8rem; min-width: 0; }
.bench .group { width: 100%; border-bottom: 1px solid var(--line); }
.bench .group .nicegui-expansion-content { padding: 0 .9rem .8rem; }
.bench .item { width: 100%; border: 1px solid var(--line); border-radius: 4px; }
.bench .head { width: 100%; min-width: 0; flex: 1; align-items: baseline; gap: .6rem; flex-wrap: nowrap; }
.bench .q-btn { color: var(--mark); }
.bench .q-btn.bg-primary { color: #15181b !important; }
.bench .head .faint { overflow: hidden; text-overflow: ellipsis; white-space: nowrap; }
.bench .name { font-weight: 600; white-space: nowrap; }
.bench .fields { width: 100%; gap: .15rem; }
.bench .table { width: 100%; gap: .15rem; margin-top: .6rem; padding-left: .7rem; border-left: 2px solid var(--line); }
.bench .wide { width: 100%; }
.bench .note { color: var(--faint); font-size: 11.5px; line-height: 1.3; margin: 0 0 .5rem .2rem; }
.bench .wrong { color: var(--wrong) !important; }
.bench .head .faint.wrong { white-space: normal; }
.bench .problems { width: 100%; gap: .2rem; padding: .5rem .9rem; background: #3a211d; color: var(--wrong); border: 1px solid #693a31;
  border-radius: 4px; }
.bench .banner { padding: 1rem; }
.bench .pictures { width: 100%; gap: .8rem; align-items: stretch; }
.bench .card { background: var(--panel); border: 1px solid var(--line); border-radius: 4px; padding: .6rem .8rem; gap: .35rem; width: 100%;
  min-width: 0; }
.bench .two { flex: 1 1 420px; width: auto; }
.bench .third { flex: 1 1 260px; width: auto; }
.bench .picture { width: 100%; }
.bench .picture.middle { display: flex; justify-content: center; }
.bench .picture.old { opacity: .35; }
.bench .text { width: 100%; }
.bench .text pre { margin: 0; font: 12.5px/1.45 ui-monospace, "DejaVu Sans Mono", monospace; white-space: pre-wrap; max-height: 22rem;
  overflow-y: auto; }
.bench .command { border-top: 1px solid var(--line); padding-top: .25rem; align-items: center; }
.bench .code { font: 12.5px ui-monospace, "DejaVu Sans Mono", monospace; user-select: all; overflow-x: auto; white-space: nowrap; }
.bench .q-field--outlined .q-field__control:before { border-color: var(--line); }
.bench .q-field__native::placeholder { color: #66717a; opacity: 1; }
@media (max-width: 900px) { .bench .columns { grid-template-columns: minmax(0, 1fr); }
  .bench .left { height: auto; position: static; border-right: 0; } }
"""
