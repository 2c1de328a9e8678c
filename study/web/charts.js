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

const near_whole = (x) => Math.abs(x - Math.round(x)) < 1e-6;

function log_axis(name, range, more) {
  const label = (v) => (v === range.zero ? "0" : near_whole(Math.log10(v)) ? power_of_ten(Math.round(Math.log10(v))) : range.ticks ? number(v, 1) : "");
  const only = range.ticks ? {customValues: range.ticks} : {};
  return {
    type: "log", min: range.min, max: range.max, name, nameLocation: "middle", nameTextStyle: kText,
    axisLabel: {...kText, hideOverlap: true, formatter: label, ...only},
    axisLine: {show: true, onZero: false, lineStyle: {color: "#444"}}, axisTick: {show: true, ...only},
    splitLine: {show: true, lineStyle: {color: "#ddd"}}, minorTick: {show: !range.ticks, splitNumber: 9}, ...more,
  };
}

// An axis close around the values of a setting: logarithmic with ticks at 1, 2 and 5, or plain with ticks at the values.
function setting_axis(parameter, xs) {
  const plain = {name: parameter.label, nameLocation: "middle", nameGap: 32, nameTextStyle: kText, axisLabel: kText,
    axisLine: {show: true, onZero: false, lineStyle: {color: "#444"}}, splitLine: {show: true, lineStyle: {color: "#eee"}}};
  if (parameter.names.length) return {...plain, type: "category", data: parameter.names};
  const low = Math.min(...xs), high = Math.max(...xs);
  if (parameter.logarithmic) {
    const range = {min: low / 1.3, max: high * 1.3, zero: null, ticks: []};
    for (let e = Math.floor(Math.log10(low)) - 1; e <= Math.log10(high) + 1; ++e)
      for (const digit of [1, 2, 5]) {
        const tick = Number(`${digit}e${e}`);
        if (tick >= range.min && tick <= range.max) range.ticks.push(tick);
      }
    return log_axis(parameter.label, range, {nameGap: 32});
  }
  const margin = high > low ? 0.06 * (high - low) : 1, values = [...new Set(xs)];
  const only = values.length <= 12 ? {customValues: values} : {};
  return {...plain, type: "value", min: Number((low - margin).toPrecision(6)), max: Number((high + margin).toPrecision(6)),
    axisTick: {show: true, ...only}, axisLabel: {...kText, showMinLabel: values.length <= 12, showMaxLabel: values.length <= 12,
      hideOverlap: true, formatter: (v) => number(v), ...only}};
}

function base_options(x_axis, y_axis, legend) {
  const slim = narrow();
  return {
    animation: false, textStyle: {fontFamily: "system-ui, sans-serif"},
    grid: {left: slim ? 54 : 70, right: slim ? 14 : 30, top: slim ? 64 : 40, bottom: 56},
    legend: {type: "scroll", top: 0, left: 0, right: slim ? 0 : 120, itemWidth: 16, itemHeight: 11, textStyle: kText, data: legend},
    toolbox: {top: slim ? 30 : 0, right: 0, iconStyle: {borderColor: "#333"}, feature: {
      dataZoom: {title: {zoom: "select a part", back: "back"}},
      restore: {title: "all of it"}, saveAsImage: {title: "save as SVG"}}},
    tooltip: {trigger: "item", confine: true, formatter: (p) => (p.data && p.data.point !== undefined ? tip(p.data.point) : "")},
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
  const legend = study.series.map((s) => s.name).concat([{name: "Pareto front", itemStyle: {opacity: 0}}]);
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

// Where an order's line leaves the chart below, its end stands there; its name stands beside its middle.
function order_parts(order, range, axis) {
  const [[x0, y0], [x1, y1]] = order.line;
  const logarithmic = axis.type === "log";
  const along = (t) => (logarithmic ? x0 * (x1 / x0) ** t : x0 + (x1 - x0) * t);
  const at = (t) => [along(t), y0 * (y1 / y0) ** t];
  const end = y1 >= range.min ? 1 : Math.log(range.min / y0) / Math.log(y1 / y0);
  return {line: [at(0), at(end)], middle: at(0.6 * end), falling: (x1 > x0) !== (y1 > y0)};
}

function draw_parameter(parameter, element) {
  const error = study.errors[state.error];
  const has = study.points.map((point, n) => parameter.x[n] !== null && shown(error.values[n]) && point.status === "done");
  const range = log_range(error.values.filter((_, n) => has[n]));
  const named = parameter.names.length > 0;
  const place = (n) => [named ? parameter.names[parameter.x[n]] : parameter.x[n], placed(error.values[n], range)];
  const xs = parameter.x.filter((_, n) => has[n]);
  element.style.display = xs.length ? "" : "none";
  if (!xs.length) return;
  const x_axis = setting_axis(parameter, xs);
  const options = base_options(x_axis, log_axis(error.label, range, {nameGap: narrow() ? 40 : 52}));
  delete options.toolbox;
  delete options.legend;
  options.grid.top = 16;
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
  parameter.orders[state.error].forEach((order, k) => {
    const {line, middle, falling} = order_parts(order, range, x_axis);
    const left = falling === (k % 2 === 0);
    options.series.push({name: order.label, type: "line", symbol: "none", silent: true, z: 4,
      lineStyle: {type: "dashed", width: 1.5, color: "#000"}, data: line});
    options.series.push({name: order.label, type: "scatter", symbolSize: 0.01, silent: true, z: 5, data: [middle],
      label: {show: true, position: left ? "left" : "right", distance: 8, offset: [0, falling === left ? 8 : -8], color: "#000", fontSize: 12,
        formatter: order.label.replace(/\^(-?\d+)/g, (_, n) => superscript(n)), textBorderColor: "#fff", textBorderWidth: 3}});
  });
  options.series.push({name: "floor", type: "line", data: [], markArea: floor_band(error.floor, range)});
  chart_in(element, `${error.label} against ${parameter.label}: ${xs.length} points`).setOption(options, true);
}

// One legend for all settings' charts.
function draw_series_names() {
  const paths = ["M5 0A5 5 0 1 0 5.01 0Z", "M0 0H10V10H0Z", "M5 0L10 10H0Z", "M5 0L10 5L5 10L0 5Z", ...kSymbols.slice(4).map((s) => s.slice(7))];
  document.getElementById("series").innerHTML = study.series.map((s) =>
    `<span><svg width="11" height="11" viewBox="0 0 10 10" aria-hidden="true"><path d="${paths[s.symbol]}" fill="${s.colour}"/></svg> ${escape_html(s.name)}</span>`).join(" ");
}

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
    for (const [name, order, type] of [["dt", 1, "dotted"], ["dt²", 2, "dashed"]])
      options.series.push({name, type: "line", symbol: "none", silent: true, color: "#000", lineStyle: {type, color: "#000"},
        data: [[first.dt, first.trajectory], [last.dt, first.trajectory * (last.dt / first.dt) ** order]]});
  chart_in(element, "How much the truth changed with each rung of its refinement").setOption(options, true);
}
