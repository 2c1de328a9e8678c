// SPDX-License-Identifier: MIT
// Draws the charts that study/report/chart.h describes, by Apache ECharts. A mark of a study's point carries its index, for hovering
// and choosing.
"use strict";

const kSymbols = ["circle", "rect", "triangle", "diamond", "path://M0 0H10L5 9Z", "path://M5 0L10 3.8L8.1 10H1.9L0 3.8Z",
  "path://M1 0L5 4L9 0L10 1L6 5L10 9L9 10L5 6L1 10L0 9L4 5L0 1Z"];
const kText = {color: "#333", fontSize: 13};
const narrow = () => window.innerWidth < 640;
const charts = [];

function axis_options(axis, nameGap) {
  const ticks = {customValues: axis.ticks.map(([at]) => at)};
  const name_of = (v) => (axis.ticks.find(([at]) => Math.abs(at - v) <= 1e-6 * Math.abs(v)) || ["", ""])[1];
  return {
    type: axis.logarithmic ? "log" : "value", min: axis.range[0], max: axis.range[1],
    name: axis.label, nameLocation: "middle", nameGap, nameTextStyle: kText, nameTruncate: {maxWidth: narrow() ? 300 : 460},
    axisLabel: {...kText, hideOverlap: true, width: 160, overflow: "truncate", formatter: name_of, ...ticks},
    axisLine: {show: true, onZero: false, lineStyle: {color: "#444"}}, axisTick: {show: true, ...ticks},
    minorTick: {show: axis.decades && axis.ticks.length < 10, splitNumber: 9}, splitLine: {show: true, lineStyle: {color: "#ddd"}},
  };
}

function base_options(chart) {
  const slim = narrow();
  const names = chart.plotted.filter((p, k) => chart.plotted.findIndex((q) => q.name === p.name) === k)
    .map((p) => ({name: p.name, itemStyle: p.symbol < 0 ? {opacity: 0} : {}}));
  const key = chart.key ? {
    legend: {type: "scroll", top: 0, left: 0, width: slim ? "100%" : "86%", itemWidth: 16, itemHeight: 11, textStyle: kText, data: names},
    toolbox: {top: slim ? 30 : 0, right: 0, iconStyle: {borderColor: "#333"}, feature: {
      dataZoom: {title: {zoom: "select a part", back: "back"}},
      restore: {title: "all of it"}, saveAsImage: {title: "save as SVG"}}},
  } : {};
  const tip_of = ({data}) => (chart.tips.length
    ? data && data.row !== undefined ? `<div class="tip">${escape_html(chart.tips[data.row]).replace(/\n/g, "<br>")}</div>` : ""
    : data && data.point !== undefined ? tip(data.point) : "");
  return {
    animation: false, textStyle: {fontFamily: "system-ui, sans-serif"},
    grid: {left: slim ? 54 : 70, right: slim ? 14 : 30, top: !chart.key ? 16 : slim ? 64 : 40, bottom: 56},
    title: {text: chart.corner, bottom: 62, [chart.corner_left ? "left" : "right"]: chart.corner_left ? (slim ? 58 : 76) : (slim ? 18 : 36),
      textStyle: {...kText, fontWeight: "normal"}, padding: 0},
    tooltip: {trigger: "item", confine: true, formatter: tip_of},
    dataZoom: [0, 1].map((axis) => ({type: "inside", [axis ? "yAxisIndex" : "xAxisIndex"]: 0, filterMode: "none",
      zoomOnMouseWheel: "shift", moveOnMouseMove: "shift", moveOnMouseWheel: false, preventDefaultMouseMove: false})),
    xAxis: axis_options(chart.x, 32), yAxis: axis_options(chart.y, slim ? 40 : 52), ...key,
  };
}

// The name of a line that no key tells stands beside its middle place; those of lines that follow one another on either side.
function beside(plotted, k) {
  const [[x0, y0], , [x1, y1]] = plotted.places;
  const falling = (x1 > x0) !== (y1 > y0), left = falling === (k % 2 === 0);
  return {show: true, position: left ? "left" : "right", distance: 8, offset: [0, falling === left ? 8 : -8], color: "#000",
    fontSize: 12, formatter: () => plotted.name, textBorderColor: "#fff", textBorderWidth: 3};
}

function line_series(plotted, k, named) {
  const middle = plotted.places.length >> 1;
  return {name: plotted.name, type: "line", silent: true, color: plotted.colour, lineStyle: {type: plotted.stroke, width: plotted.width},
    symbol: named ? "none" : "circle", symbolSize: 0.01, showAllSymbol: true,
    data: plotted.places.map(([x, y]) => (x === null ? ["-", "-"] : [x, y])).map((value, p) => ({value, label: !named && p === middle ? beside(plotted, k) : {show: false}}))};
}

function mark_series(chart, plotted) {
  const place = (axis, row) => (axis.logarithmic && axis.values[row] === 0 ? axis.range[0] : axis.values[row]);
  const joined = plotted.stroke !== "none", of_points = !chart.tips.length;
  const best = new Set(chart.best);
  const mark = (row) => ({value: [place(chart.x, row), place(chart.y, row)], ...(of_points ? {point: row} : {row}),
    ...(best.has(row) ? {symbolSize: 14, itemStyle: {borderColor: "#000", borderWidth: 1.5, opacity: 1}} : {})});
  return {name: plotted.name, type: joined ? "line" : "scatter", symbol: kSymbols[plotted.symbol], symbolSize: plotted.size,
    color: plotted.colour, showAllSymbol: true, itemStyle: {opacity: joined ? 1 : 0.75},
    lineStyle: {width: plotted.width, opacity: of_points ? 0.55 : 1},
    data: plotted.rows.flatMap((rows) => [...rows.filter((row) => !of_points || is_shown(row)).map(mark), {value: ["-", "-"]}])};
}

const band_series = ({band, y, corner_left}) => ({type: "line", data: [], markArea: band && {silent: true, itemStyle: {color: "rgba(120,120,120,0.16)"},
  label: {show: true, position: corner_left ? "insideBottomRight" : "insideBottomLeft", color: "#555", fontSize: 12, formatter: () => band[1]},
  data: [[{yAxis: y.range[0]}, {yAxis: band[0]}]]}});

function draw_chart(element, chart) {
  let drawn = echarts.getInstanceByDom(element);
  if (!drawn) {
    drawn = echarts.init(element, null, {renderer: "svg"});
    drawn.on("click", (event) => { if (event.data && event.data.point !== undefined) choose(event.data.point); });
    charts.push(drawn);
  }
  element.setAttribute("aria-label", chart.title);
  const lines = chart.plotted.filter((p) => p.places.length);
  const series = chart.plotted.map((p) => (p.places.length ? line_series(p, lines.indexOf(p), chart.key) : mark_series(chart, p)));
  drawn.setOption({...base_options(chart), series: [band_series(chart), ...series].map((s, z) => ({...s, z}))}, true);
}

// The charts of what was chosen, each in its section.
function draw_charts() {
  for (const section of document.querySelectorAll(".charts")) {
    const chosen = study.charts.filter((c) => c.section === section.id && ["error", "speed"].every((m) => c[m] === null || c[m] === state[m]));
    while (section.children.length < chosen.length) {
      const chart = element("div", undefined, "chart");
      chart.id = `${section.id}-${section.children.length}`;
      chart.setAttribute("role", "img");
      section.append(chart);
    }
    [...section.children].forEach((chart, k) => {
      chart.style.display = k < chosen.length ? "" : "none";
      if (k < chosen.length) draw_chart(chart, chosen[k]);
    });
    section.nextElementSibling.firstElementChild.textContent = chosen.length ? [...new Set(chosen.map((c) => c.caption))].join(" ") : section.dataset.none;
  }
}

// One key for all settings' charts.
function draw_series_names() {
  const paths = ["M5 0A5 5 0 1 0 5.01 0Z", "M0 0H10V10H0Z", "M5 0L10 10H0Z", "M5 0L10 5L5 10L0 5Z", ...kSymbols.slice(4).map((s) => s.slice(7))];
  document.getElementById("series").innerHTML = study.series.map((s) =>
    `<span><svg width="11" height="11" viewBox="0 0 10 10" aria-hidden="true"><path d="${paths[s.symbol]}" fill="${s.colour}"/></svg> ${escape_html(s.name)}</span>`).join(" ");
}
