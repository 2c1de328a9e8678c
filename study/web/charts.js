// SPDX-License-Identifier: MIT
// The charts, by Apache ECharts. Each mark carries the index of its point, for hovering and choosing.
"use strict";

const kSymbols = ["circle", "rect", "triangle", "diamond", "path://M0 0H10L5 9Z",
  "path://M5 0L10 3.8L8.1 10H1.9L0 3.8Z"];
const kCross = "path://M1 0L5 4L9 0L10 1L6 5L10 9L9 10L5 6L1 10L0 9L4 5L0 1Z";
const kText = {color: "#333", fontSize: 13};
const narrow = () => window.innerWidth < 640;
const charts = [];

function chart_in(element, label) {
  let chart = echarts.getInstanceByDom(element);
  if (!chart) {
    chart = echarts.init(element, null, {renderer: "svg"});
    chart.on("click", (event) => { if (event.data && event.data.point !== undefined) choose(event.data.point); });
    charts.push(chart);
  }
  element.setAttribute("aria-label", label);
  return chart;
}

// Decades that hold all values. Where a value is 0, one more below stands for it, apart from all others.
function log_range(values) {
  const some = values.filter((v) => v !== null && v > 0);
  const zero = values.some((v) => v === 0);
  let low = some.length ? Math.floor(Math.log10(Math.min(...some)) + 1e-9) : -1;
  let high = some.length ? Math.ceil(Math.log10(Math.max(...some)) - 1e-9) : 0;
  if (high === low) high += 1;
  if (zero) low -= 1;
  return {min: 10 ** low, max: 10 ** high, zero: zero ? 10 ** low : null};
}
const placed = (value, range) => (value === 0 ? range.zero : value);
const shown = (value) => value !== null && value !== undefined && value >= 0;

function log_axis(name, range, more) {
  return Object.assign({
    type: "log", min: range.min, max: range.max, name, nameLocation: "middle", nameTextStyle: kText,
    axisLabel: {...kText, hideOverlap: true, formatter: (v) => (v === range.zero ? "0" : Math.abs(Math.log10(v) % 1) < 1e-6 || Math.abs(Math.log10(v) % 1) > 1 - 1e-6 ? power_of_ten(Math.round(Math.log10(v))) : "")},
    axisLine: {show: true, onZero: false, lineStyle: {color: "#444"}}, axisTick: {show: true},
    splitLine: {show: true, lineStyle: {color: "#ddd"}}, minorTick: {show: true, splitNumber: 9},
  }, more);
}

function base_options(x_axis, y_axis, legend) {
  const slim = narrow();
  return {
    animation: false, textStyle: {fontFamily: "system-ui, sans-serif"},
    grid: {left: slim ? 54 : 70, right: slim ? 14 : 30, top: slim ? 84 : 64, bottom: 56},
    legend: {type: "scroll", top: 0, left: 0, right: slim ? 0 : 120, textStyle: kText, data: legend},
    toolbox: {top: slim ? 30 : 0, right: 0, iconStyle: {borderColor: "#333"}, feature: {
      dataZoom: {title: {zoom: "select a part", back: "back"}},
      restore: {title: "all of it"}, saveAsImage: {title: "save as SVG"}}},
    tooltip: {trigger: "item", confine: true, enterable: true, formatter: (p) => (p.data && p.data.point !== undefined ? tip(p.data.point) : "")},
    dataZoom: [0, 1].map((axis) => ({type: "inside", [axis ? "yAxisIndex" : "xAxisIndex"]: 0, filterMode: "none",
      zoomOnMouseWheel: "shift", moveOnMouseMove: "shift", moveOnMouseWheel: false, preventDefaultMouseMove: false})),
    xAxis: x_axis, yAxis: y_axis, series: [],
  };
}

// The truth's own uncertainty: an error below it tells nothing.
function floor_band(floor, range) {
  if (!floor || floor <= range.min) return undefined;
  return {silent: true, itemStyle: {color: "rgba(120,120,120,0.16)"},
    label: {show: true, position: "insideBottomRight", color: "#555", fontSize: 12, formatter: "below: the truth's own error"},
    data: [[{yAxis: range.min}, {yAxis: Math.min(floor, range.max)}]]};
}

function draw_error_speed() {
  const element = document.getElementById("error-speed");
  const error = study.errors[state.error], speed = study.speeds[state.speed];
  if (!error || !speed) { element.textContent = "No point has both an error and a speed."; return; }
  const has = study.points.map((point, n) => shown(error.values[n]) && speed.values[n] !== null && speed.values[n] > 0);
  const y = log_range(error.values.filter((_, n) => has[n])), x = log_range(speed.values.filter((_, n) => has[n]));
  const front = study.choices[state.error][state.speed].front;
  const on_front = new Set(front);
  const legend = study.series.map((s) => s.name).concat(["Pareto front"]);
  const place = (n) => [speed.values[n], placed(error.values[n], y)];
  const options = base_options(log_axis(speed.label, x, {nameGap: 32, inverse: speed.less}),
    log_axis(error.label, y, {nameGap: narrow() ? 40 : 52}), legend);
  for (const series of study.series) {
    const points = series.points.filter((n) => has[n] && study.points[n].status === "done");
    options.series.push({name: series.name, type: "scatter", symbol: kSymbols[series.symbol], color: series.colour, z: 3,
      data: points.map((n) => ({value: place(n), point: n, symbolSize: on_front.has(n) ? 14 : 9,
        itemStyle: on_front.has(n) ? {borderColor: "#000", borderWidth: 1.5, opacity: 1} : {opacity: 0.75}}))});
  }
  const unstable = study.points.map((_, n) => n).filter((n) => has[n] && study.points[n].status === "unstable");
  if (unstable.length) {
    legend.push({name: "unstable", icon: kCross});
    options.series.push({name: "unstable", type: "scatter", symbol: kCross, symbolSize: 9, color: "#777", z: 2,
      data: unstable.map((n) => ({value: place(n), point: n, itemStyle: {color: series_of_point[n].colour, opacity: 0.7}}))});
  }
  // Between two points of the front the more exact one has to serve: a stair.
  const stair = [];
  front.forEach((n, k) => {
    if (k > 0) stair.push([speed.values[n], placed(error.values[front[k - 1]], y)]);
    stair.push(place(n));
  });
  options.series.push({name: "Pareto front", type: "line", symbol: "none", silent: true, color: "#222", z: 1,
    lineStyle: {width: 1.5, color: "#222"}, data: stair, markArea: floor_band(error.floor, y)});
  chart_in(element, `${error.label} against ${speed.label}: ${has.filter(Boolean).length} points, ${front.length} on the Pareto front`)
    .setOption(options, true);
}

function draw_parameter(parameter, element) {
  const error = study.errors[state.error];
  const orders = parameter.orders[state.error];
  const has = study.points.map((point, n) => parameter.x[n] !== null && shown(error.values[n]) && point.status === "done");
  const values = error.values.filter((_, n) => has[n]);
  const range = log_range(values);
  const named = parameter.names.length > 0;
  const place = (n) => [named ? parameter.names[parameter.x[n]] : parameter.x[n], placed(error.values[n], range)];
  const xs = parameter.x.filter((x) => x !== null);
  const low = Math.min(...xs), high = Math.max(...xs), margin = 0.06 * (high - low);
  const plain = {name: parameter.label, nameLocation: "middle", nameGap: 32, nameTextStyle: kText, axisLabel: kText,
    axisLine: {show: true, onZero: false, lineStyle: {color: "#444"}}, splitLine: {show: true, lineStyle: {color: "#eee"}}};
  const x_axis = named ? {...plain, type: "category", data: parameter.names}
    : parameter.logarithmic ? log_axis(parameter.label, log_range(xs), {nameGap: 32})
    : {...plain, type: "value", min: Number((low - margin).toPrecision(6)), max: Number((high + margin).toPrecision(6)),
       axisLabel: {...kText, showMinLabel: false, showMaxLabel: false}};
  const names = study.series.map((s) => s.name);
  const options = base_options(x_axis, log_axis(error.label, range, {nameGap: narrow() ? 40 : 52}), names);
  delete options.toolbox;
  options.legend.right = 0;
  options.grid.top = 44;
  const joined = new Set();
  for (const sweep of parameter.sweeps) {
    const points = sweep.filter((n) => has[n]);
    if (points.length < 2) continue;
    points.forEach((n) => joined.add(n));
    const series = series_of_point[points[0]];
    options.series.push({name: series.name, type: "line", symbol: kSymbols[series.symbol], symbolSize: 7, showSymbol: true,
      color: series.colour, lineStyle: {width: 1, opacity: 0.55}, z: 3, data: points.map((n) => ({value: place(n), point: n}))});
  }
  for (const series of study.series)
    options.series.push({name: series.name, type: "scatter", symbol: kSymbols[series.symbol], symbolSize: 6, color: series.colour,
      itemStyle: {opacity: 0.6}, data: series.points.filter((n) => has[n] && !joined.has(n)).map((n) => ({value: place(n), point: n}))});
  for (const order of orders)
    options.series.push({name: order.label, type: "line", symbol: "none", silent: true, clip: true, color: "#000", z: 4,
      lineStyle: {type: "dashed", width: 1.5, color: "#000"}, data: order.line,
      markPoint: {silent: true, symbol: "rect", symbolSize: [1, 1], itemStyle: {opacity: 0}, data: [{coord: order_label(order, range)}],
        label: {show: true, position: "top", color: "#000", fontSize: 12, formatter: order.label,
          textBorderColor: "#fff", textBorderWidth: 3}}});
  options.series.push({name: "floor", type: "line", data: [], markArea: floor_band(error.floor, range)});
  chart_in(element, `${error.label} against ${parameter.label}`).setOption(options, true);
}

// The coarse end: there the line is inside of the chart.
const order_label = (order) => order.line[0];

function draw_parameters() {
  const grid = document.getElementById("parameters");
  if (!study.errors.length) return;
  study.parameters.forEach((parameter, k) => {
    if (!grid.children[k]) {
      const element = document.createElement("div");
      element.className = "chart";
      element.id = "parameter-" + k;
      element.setAttribute("role", "img");
      grid.append(element);
    }
    draw_parameter(parameter, grid.children[k]);
  });
  if (!study.parameters.length) grid.textContent = "No setting takes more than one value.";
}

function draw_truth() {
  const element = document.getElementById("truth-chart");
  const rungs = study.truth.rungs;
  if (rungs.length < 2) { element.style.display = "none"; return; }
  const last = rungs[rungs.length - 1];
  const by_dt = new Set(rungs.map((r) => r.dt)).size === rungs.length;
  const lines = [["trajectory: distance from the rung before, pitches", rungs.map((r) => r.trajectory)],
    ...study.figure_names.map((name, k) => [name + ": relative distance from the last rung",
      rungs.map((r) => (r === last || !last.figures[k] || r.figures[k] === null ? null : Math.abs(r.figures[k] / last.figures[k] - 1)))])];
  const values = lines.flatMap(([, v]) => v.filter((x) => x !== null && x > 0));
  if (!values.length) { element.style.display = "none"; return; }
  const range = log_range(values);
  const x_axis = by_dt ? log_axis("time step, s", log_range(rungs.map((r) => r.dt)), {nameGap: 32, inverse: true})
    : {type: "category", name: "rung", nameLocation: "middle", nameGap: 32, nameTextStyle: kText, data: rungs.map((_, k) => String(k + 1))};
  const options = base_options(x_axis, log_axis("change", range, {nameGap: narrow() ? 40 : 52}), undefined);
  delete options.toolbox;
  options.tooltip.formatter = (p) => `<div class="tip">${escape_html(p.seriesName)}<br>rung ${p.data.rung + 1}: ${number(p.value[1])}</div>`;
  lines.forEach(([name, v], k) => options.series.push({name, type: "line", symbol: kSymbols[k % kSymbols.length], symbolSize: 8,
    color: ["#0072b2", "#d55e00", "#00875f", "#aa4499", "#332288", "#7a6a00"][k % 6],
    data: v.map((x, r) => ({value: [by_dt ? rungs[r].dt : String(r + 1), x], rung: r})).filter((d) => d.value[1] !== null && d.value[1] > 0)}));
  const first = rungs.find((r) => r.trajectory !== null && r.trajectory > 0);
  if (by_dt && first && first !== last)
    options.series.push({name: "dt²", type: "line", symbol: "none", silent: true, color: "#000", lineStyle: {type: "dashed", color: "#000"},
      data: [[first.dt, first.trajectory], [last.dt, first.trajectory * (last.dt / first.dt) ** 2]]});
  chart_in(element, "How much the truth changed with each rung of its refinement").setOption(options, true);
}
