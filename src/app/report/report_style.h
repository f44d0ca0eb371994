#pragma once

namespace render2mpeg::app {

/// The style sheet of reports: light and dark, from a phone's width to a desktop's; plots scroll sideways where there
/// is no room. Colours of I, P and B pictures, and of two layers, differ in lightness too, for eyes that see no
/// colours.
inline constexpr const char* report_style = R"(
:root { color-scheme: light dark; --text: #1b1f24; --soft: #5b6570; --line: #d8dde3; --page: #ffffff; --card: #f4f6f8;
        --i: #9e2a2b; --p: #2f6fb0; --b: #a9bccd; --one: #2f6fb0; --two: #e09f3e; --c3: #3b8f6b; --c4: #7a4fa3;
        --c5: #6b6f76; --good: #1d7a46; --fair: #8f6400; --poor: #b3261e; }
@media (prefers-color-scheme: dark) {
  :root { --text: #e6e9ec; --soft: #9aa5b1; --line: #343c45; --page: #14181d; --card: #1e242b;
          --i: #ff8c7a; --p: #5fa3e6; --b: #55687a; --one: #5fa3e6; --two: #f2b950;
          --c3: #6fcaa2; --c4: #c39be8; --c5: #aab2bb; --good: #6fd39a; --fair: #f0c060; --poor: #ff8a80; } }
* { box-sizing: border-box; }
body { margin: 0; background: var(--page); color: var(--text); font: 16px/1.5 system-ui, sans-serif; }
main { max-width: 74rem; margin: 0 auto; padding: 1rem; }
h1 { font-size: 1.6rem; margin: .5rem 0; overflow-wrap: anywhere; }
h2 { font-size: 1.2rem; margin: 2.2rem 0 .6rem; border-bottom: 1px solid var(--line); }
h3 { font-size: 1rem; margin: 0; }
h3 small, .soft { color: var(--soft); font-weight: normal; }
.lead { font-size: 1.15rem; overflow-wrap: anywhere; }
figure { margin: 1.2rem 0; }
figcaption { display: flex; flex-wrap: wrap; gap: .2rem 1rem; justify-content: space-between; }
.key { display: inline-block; margin-right: .9rem; font-size: .85rem; color: var(--soft); white-space: nowrap; }
.wide { overflow-x: auto; }
svg { display: block; width: 100%; height: auto; }
svg text { font: 12px system-ui, sans-serif; fill: var(--soft); }
svg .grid { stroke: var(--line); stroke-width: 1; }
.curves .line { fill: none; stroke: currentColor; stroke-width: 1.8; stroke-linejoin: round; }
.curves svg g { fill: currentColor; } .curves .ring { fill: none; stroke: currentColor; stroke-width: 1.5; }
.curves .narrow { display: none; }
@media (max-width: 40rem) { .curves .broad { display: none; } .curves .narrow { display: block; } }
.one { background: var(--one); }
.pair { --at: 50%; }
.upon { position: relative; }
.upon img, .heat img { display: block; width: 100%; height: auto; image-rendering: pixelated; }
.upon img + img { position: absolute; inset: 0; clip-path: inset(0 0 0 var(--at)); }
.heat { display: inline-block; width: min(100%, 27rem); margin: 1.2rem 1rem 0 0; vertical-align: top; }
.grip { display: flex; flex-wrap: wrap; justify-content: space-between; color: var(--soft); font-size: .85rem; }
.grip input { width: 100%; margin: .3rem 0; height: 1.6rem; accent-color: var(--one); }
@media print { .grip input { display: none; } }
.upon img + img + img { clip-path: none; visibility: hidden; }
.differs .upon img + img + img { visibility: visible; }
.upon::after { content: ""; position: absolute; top: 0; bottom: 0; left: var(--at); width: 2px; background: #fff;
              box-shadow: 0 0 2px #000; }
.differs .upon::after { display: none; }
.grip label { width: 100%; cursor: pointer; }
.grip label input { width: auto; height: auto; margin: 0 .3rem 0 0; vertical-align: middle; }
.screen { display: grid; grid-template-columns: minmax(0, 1.15fr) minmax(0, 1fr); gap: 1.5rem; align-items: start; }
.screen figure { margin-top: 0; } .screen .upon, .screen .grip { max-width: 100% !important; }
@media (max-width: 54rem) { .screen { grid-template-columns: minmax(0, 1fr); } }
.answer td { padding: .45rem .7rem .45rem 0; } .answer .taken { background: var(--card); font-weight: 600; }
.answer th { color: var(--soft); font-weight: normal; font-size: .85rem; }
.answer .bars { width: 28%; font-variant-numeric: tabular-nums; } .answer small { color: var(--soft); font-weight: normal; }
.len { height: .45rem; min-width: 2px; border-radius: 3px; background: var(--one); margin: .35rem 0 .1rem; }
.badge { background: var(--one); color: var(--page); border-radius: 1rem; padding: .05rem .6rem; font-size: .75rem;
         white-space: nowrap; }
.good { color: var(--good); } .fair { color: var(--fair); } .poor { color: var(--poor); }
.thumb { display: block; width: 7rem; padding: 0; border: 0; background: none; cursor: pointer; }
@media (max-width: 40rem) { .thumb { width: 4.5rem; } }
.thumb img { display: block; width: 100%; height: auto; border-radius: .2rem; }
details { margin: 1.4rem 0; } summary { cursor: pointer; font-weight: 600; }
table { border-collapse: collapse; width: 100%; font-size: .92rem; }
th, td { text-align: left; padding: .25rem .8rem .25rem 0; border-bottom: 1px solid var(--line); vertical-align: top; }
td:nth-child(2):last-child { overflow-wrap: anywhere; } td.n, th.n { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
tr.off td { color: var(--soft); }
td.bar { width: 35%; min-width: 6rem; }
td.bar div { height: .8rem; border-radius: 2px; }
pre { background: var(--card); padding: .7rem; border-radius: .4rem; white-space: pre-wrap; overflow-wrap: anywhere; }
)";

}  // namespace render2mpeg::app
