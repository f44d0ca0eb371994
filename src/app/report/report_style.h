#pragma once

namespace render2mpeg::app {

/// The style sheet of reports: light and dark, from a phone's width to a desktop's; plots scroll sideways where there
/// is no room. Colours of I, P and B pictures, and of two layers, differ in lightness too, for eyes that see no
/// colours.
inline constexpr const char* report_style = R"(
:root { color-scheme: light dark; --text: #1b1f24; --soft: #5b6570; --line: #d8dde3; --page: #ffffff; --card: #f4f6f8;
        --i: #9e2a2b; --p: #2f6fb0; --b: #a9bccd; --one: #2f6fb0; --two: #e09f3e; }
@media (prefers-color-scheme: dark) {
  :root { --text: #e6e9ec; --soft: #9aa5b1; --line: #343c45; --page: #14181d; --card: #1e242b;
          --i: #ff8c7a; --p: #5fa3e6; --b: #55687a; --one: #5fa3e6; --two: #f2b950; } }
* { box-sizing: border-box; }
body { margin: 0; background: var(--page); color: var(--text); font: 16px/1.5 system-ui, sans-serif; }
main { max-width: 60rem; margin: 0 auto; padding: 1rem; }
h1 { font-size: 1.6rem; margin: .5rem 0; overflow-wrap: anywhere; }
h2 { font-size: 1.2rem; margin: 2.2rem 0 .6rem; border-bottom: 1px solid var(--line); }
h3 { font-size: 1rem; margin: 0; }
h3 small, .soft { color: var(--soft); font-weight: normal; }
.lead { font-size: 1.15rem; overflow-wrap: anywhere; }
.cards { display: grid; grid-template-columns: repeat(auto-fill, minmax(9.5rem, 1fr)); gap: .6rem; margin: 0; }
.cards div { background: var(--card); border-radius: .4rem; padding: .5rem .7rem; }
.cards dt { color: var(--soft); font-size: .85rem; }
.cards dd { margin: 0; font-size: 1.2rem; font-variant-numeric: tabular-nums; }
figure { margin: 1.2rem 0; }
figcaption { display: flex; flex-wrap: wrap; gap: .2rem 1rem; justify-content: space-between; }
.key { display: inline-block; margin-right: .9rem; font-size: .85rem; color: var(--soft); white-space: nowrap; }
.swatch { display: inline-block; width: .8em; height: .8em; margin-right: .35em; border-radius: 2px; }
.wide { overflow-x: auto; }
svg { display: block; width: 100%; min-width: 620px; height: auto; }
svg text { font: 12px system-ui, sans-serif; fill: var(--soft); }
svg .grid { stroke: var(--line); stroke-width: 1; }
svg g:hover rect { opacity: .6; }
.curves svg { min-width: 0; }
.curves .line { fill: none; stroke: currentColor; stroke-width: 1.8; stroke-linejoin: round; }
.curves svg g { fill: currentColor; } .curves .ring { fill: none; stroke: currentColor; stroke-width: 1.5; }
.curves .narrow { display: none; }
@media (max-width: 40rem) { .curves .broad { display: none; } .curves .narrow { display: block; } }
.i { fill: var(--i); background: var(--i); } .p { fill: var(--p); background: var(--p); }
.b { fill: var(--b); background: var(--b); }
.one { fill: var(--one); background: var(--one); } .two { fill: var(--two); background: var(--two); }
.pair { --at: 50%; }
.two { position: relative; }
.two img, .heat img { display: block; width: 100%; height: auto; image-rendering: pixelated; }
.two img + img { position: absolute; inset: 0; clip-path: inset(0 0 0 var(--at)); }
.heat { display: inline-block; width: min(100%, 27rem); margin: 1.2rem 1rem 0 0; vertical-align: top; }
.grip { display: flex; flex-wrap: wrap; justify-content: space-between; color: var(--soft); font-size: .85rem; }
.grip input { width: 100%; margin: .3rem 0; height: 1.6rem; accent-color: var(--one); }
@media print { .grip input { display: none; } }
table { border-collapse: collapse; width: 100%; font-size: .92rem; }
th, td { text-align: left; padding: .25rem .8rem .25rem 0; border-bottom: 1px solid var(--line); vertical-align: top; }
td.n, th.n { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
tr.off td { color: var(--soft); }
td.bar { width: 35%; min-width: 6rem; }
td.bar div { height: .8rem; border-radius: 2px; }
pre { background: var(--card); padding: .7rem; border-radius: .4rem; white-space: pre-wrap; overflow-wrap: anywhere; }
)";

}  // namespace render2mpeg::app
