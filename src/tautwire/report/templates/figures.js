"use strict";
/* Draws the figures when they come into view, and all of them before printing. */
(() => {
  const settings = {
    displaylogo: false,
    responsive: true,
    modeBarButtons: [["zoom2d", "pan2d", "resetScale2d", "toImage"]],
    toImageButtonOptions: { format: "svg", filename: "tautwire-figure" },
  };

  const specification = (chart) =>
    JSON.parse(document.getElementById(`${chart.id}-data`).textContent);

  /* The figures have room for the rows of the legend on a wide screen; a narrow one needs more. */
  const WIDE = 880, PER_LETTER = 7.2, SYMBOL = 48, ROW = 19;
  const fitLegend = (chart, data, layout) => {
    const names = data.filter((t) => t.name && t.showlegend !== false).map((t) => t.name);
    if (layout.showlegend === false || !names.length) return;
    const widths = names.map((name) => PER_LETTER * name.length + SYMBOL);
    const total = widths.reduce((sum, width) => sum + width, 0), widest = Math.max(...widths);
    const rows = (room) => (total <= room ? 1
      : Math.ceil(names.length / Math.max(1, Math.floor(room / widest))));
    const room = chart.clientWidth - layout.margin.l - layout.margin.r;
    const more = ROW * Math.max(0, rows(Math.min(room, WIDE)) - rows(WIDE));
    layout.margin.t += more;
    layout.height += more;
    chart.style.height = `${layout.height}px`;
  };

  const draw = (chart) => {
    if (chart.dataset.drawn) return;
    chart.dataset.drawn = "yes";
    const { data, layout } = specification(chart);
    fitLegend(chart, data, layout);
    Plotly.newPlot(chart, data, layout, settings);
  };

  const charts = [...document.querySelectorAll(".chart")];
  const nearby = new IntersectionObserver(
    (entries) => entries.filter((e) => e.isIntersecting).forEach((e) => draw(e.target)),
    { rootMargin: "800px 0px" },
  );
  charts.forEach((chart) => nearby.observe(chart));
  window.addEventListener("beforeprint", () => {
    document.querySelectorAll("details").forEach((details) => { details.open = true; });
    charts.forEach(draw);
    charts.forEach((chart) => Plotly.Plots.resize(chart));
  });

  document.querySelectorAll("button[data-range]").forEach((button) => {
    button.addEventListener("click", () => {
      const chart = document.getElementById(button.dataset.chart);
      draw(chart);
      const change = {};
      const range = JSON.parse(button.dataset.range);
      Object.keys(chart.layout)
        .filter((key) => /^xaxis\d*$/.test(key))
        .forEach((key) => { change[`${key}.range`] = range.slice(); });
      Plotly.relayout(chart, change);
    });
  });

  const links = new Map(
    [...document.querySelectorAll(".contents a")].map((a) => [a.hash.slice(1), a]),
  );
  const sections = [...document.querySelectorAll("main section")];
  const mark = () => {
    const passed = sections.filter((s) => s.getBoundingClientRect().top < 140);
    const here = passed.length ? passed[passed.length - 1] : sections[0];
    links.forEach((link, id) => link.classList.toggle("here", here && id === here.id));
  };
  document.addEventListener("scroll", mark, { passive: true });
  mark();
})();
