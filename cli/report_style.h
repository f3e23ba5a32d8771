// The style sheet of the report: light and dark.
#pragma once

namespace burnish {

inline constexpr const char* kReportStyle = R"CSS(
:root { color-scheme: light dark; --page: #f6f5f2; --card: #ffffff; --ink: #1d1c1a; --soft: #6f6b64;
  --rule: #e2dfd8; --accent: #b4541a; --series-1: #c2571a; --series-2: #2f7f9e; }
@media (prefers-color-scheme: dark) { :root { --page: #161513; --card: #1f1e1b; --ink: #ece9e3;
  --soft: #a19b91; --rule: #35332e; --accent: #f0964f; --series-1: #f0964f; --series-2: #6cc0dd; } }
* { box-sizing: border-box; }
body { margin: 0; background: var(--page); color: var(--ink);
  font: 15px/1.5 system-ui, -apple-system, "Segoe UI", "DejaVu Sans", sans-serif; }
main { max-width: 1240px; margin: 0 auto; padding: 40px 28px 64px; }
header p { color: var(--soft); margin: 4px 0 0; }
h1 { font-size: 30px; line-height: 1.2; margin: 0; font-weight: 650; letter-spacing: -0.01em;
  overflow-wrap: anywhere; }
h1 small { display: block; font-size: 13px; letter-spacing: 0.14em; text-transform: uppercase;
  color: var(--accent); font-weight: 650; margin-bottom: 6px; }
h2 { font-size: 19px; margin: 44px 0 14px; font-weight: 650; overflow-wrap: anywhere; }
h2 small { font-weight: 400; font-size: 14px; color: var(--soft); margin-left: 4px;
  display: inline-block; overflow-wrap: normal; }
.tiles { display: grid; grid-template-columns: repeat(auto-fit, minmax(190px, 1fr)); gap: 14px;
  margin-top: 26px; }
.tile, .card { background: var(--card); border: 1px solid var(--rule); border-radius: 12px; }
.tile { padding: 14px 18px 16px; }
.tile b { display: block; font-size: 25px; font-weight: 650; font-variant-numeric: tabular-nums;
  letter-spacing: -0.01em; margin: 2px 0; }
.tile span { color: var(--soft); font-size: 13px; display: block; overflow-wrap: anywhere; }
.pictures { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(270px, 100%), 1fr));
  gap: 18px; }
.pictures.three { grid-template-columns: repeat(3, 1fr); }
.pictures.four { grid-template-columns: repeat(4, 1fr); }
.pictures.view { grid-template-columns: repeat(3, minmax(0, 1fr)); }
@media (max-width: 860px) { .pictures.three, .pictures.four { grid-template-columns: 1fr 1fr; }
  .pictures.view { gap: 8px; } }
figure { margin: 0; background: var(--card); border: 1px solid var(--rule); border-radius: 12px;
  overflow: hidden; }
figure img { display: block; width: 100%; height: auto; background: #000; }
img.small { image-rendering: pixelated; }
.pictures.sheet { grid-template-columns: repeat(auto-fill, minmax(min(360px, 100%), 1fr)); }
.strip { display: grid; grid-template-columns: repeat(3, 1fr); align-items: start; }
figcaption { padding: 9px 14px 11px; font-size: 13px; color: var(--soft); }
figcaption b { color: var(--ink); font-weight: 600; }
.key { display: flex; align-items: center; gap: 10px; margin: 12px 2px 0; font-size: 13px;
  color: var(--soft); }
.key i { display: block; height: 10px; width: 220px; border-radius: 5px;
  -webkit-print-color-adjust: exact; print-color-adjust: exact; }
.charts { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(520px, 100%), 1fr));
  gap: 18px; }
.card { padding: 14px 16px; }
.card.wide { overflow-x: auto; }
.chart { width: 100%; min-width: 480px; max-width: 720px; height: auto; display: block;
  font-size: 12.5px; }
.chart text { fill: var(--soft); } .chart .label { fill: var(--ink); font-size: 13px; }
.chart .grid { stroke: var(--rule); } .chart .axis { stroke: var(--soft); fill: none; }
.chart .line { fill: none; stroke-width: 1.8; stroke-linejoin: round; }
.chart .line.first { stroke: var(--series-1); } .chart .line.second { stroke: var(--series-2); }
.chart .mark { stroke: var(--card); stroke-width: 1.5; }
.chart .mark.first { fill: var(--series-1); } .chart .mark.second { fill: var(--series-2); }
.note { color: var(--soft); font-size: 13px; margin: 10px 2px 0; }
.tables { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(460px, 100%), 1fr));
  gap: 18px; align-items: start; }
table { border-collapse: collapse; width: 100%; font-size: 14px; }
th, td { text-align: left; padding: 5px 8px 5px 0; border-bottom: 1px solid var(--rule);
  vertical-align: top; overflow-wrap: anywhere; }
tr:last-child th, tr:last-child td { border-bottom: 0; }
th { font-weight: 400; color: var(--soft); width: 44%; }
td { font-variant-numeric: tabular-nums; }
td + td { width: 28%; } thead td { font-weight: 600; }
.card + .pictures, .pictures + .pictures { margin-top: 18px; }
.note + .tables, .note + .pictures { margin-top: 10px; }
table.grid th, table.grid td { width: auto; overflow-wrap: normal; }
table.grid th { white-space: nowrap; }
h3 { font-size: 14px; margin: 0 0 6px; font-weight: 650; }
figcaption, .note, header p, .key span { overflow-wrap: anywhere; }
h2, h3 { break-after: avoid; }
figure, .tile { break-inside: avoid; }
footer { margin-top: 48px; color: var(--soft); font-size: 13px; }
)CSS";

}  // namespace burnish
