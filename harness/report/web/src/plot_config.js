/// How figures look: 'light' and 'dark' on the page, 'paper' in print, black on white with the legend below.
export function config(theme) {
  const text = {light: '#1b1f24', dark: '#e3e8ee', paper: '#000000'}[theme],
        soft = {light: '#59636e', dark: '#a3adb9', paper: '#000000'}[theme],
        line = {light: '#e6e9ed', dark: '#2b343f', paper: '#dddddd'}[theme], paper = theme === 'paper';
  return {
    background: paper ? '#ffffff' : null,
    font: 'system-ui, -apple-system, "Segoe UI", Roboto, "DejaVu Sans", sans-serif',
    axis: {
      labelColor: soft,
      titleColor: text,
      gridColor: line,
      domainColor: soft,
      tickColor: soft,
      titleFontWeight: 'normal',
      labelFontSize: paper ? 11 : 12,
      titleFontSize: paper ? 12 : 13,
      labelFlush: false,
      labelSeparation: 6
    },
    legend: {
      labelColor: text,
      titleColor: soft,
      titleFontWeight: 'normal',
      labelFontSize: paper ? 11 : 12,
      titleFontSize: paper ? 11 : 12,
      symbolSize: 80,
      symbolLimit: 0,  // every label, however many
      labelLimit: paper ? 420 : 260,
      ...(paper ? {orient: 'bottom', layout: {bottom: {direction: 'vertical', anchor: 'start', margin: 6}}} : {})
    },
    header: {labelColor: text, titleColor: soft, labelFontSize: paper ? 11 : 13},
    title: {color: text, fontSize: paper ? 12 : 13, fontWeight: 'normal'},
    text: {color: text},
    view: {stroke: paper ? '#bbbbbb' : null},
    rule: {color: soft}
  };
}
