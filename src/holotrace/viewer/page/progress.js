// The progress of a job that is still running, and the loss of iterations: live, or from the report of a finished job.

const $ = id => document.getElementById(id);

let shown = null;  // what is drawn, to draw it again in other colours

/** Draws curves [{name, points: [[x, dB], …]}] on a canvas, in the colours of the theme. */
function drawCurves(canvas, curves, label) {
  shown = [canvas, curves, label];
  const styles = getComputedStyle(document.documentElement), colour = name => styles.getPropertyValue(name).trim();
  const isDark = document.documentElement.dataset.theme === 'dark';
  const colourAt = i => (i < 4 ? colour(`--curve-${i + 1}`) : `hsl(${(i * 137) % 360} 60% ${isDark ? 70 : 38}%)`);
  const ratio = devicePixelRatio, wide = canvas.clientWidth || 340, high = 170;
  canvas.width = wide * ratio;
  canvas.height = high * ratio;
  const paint = canvas.getContext('2d'), all = curves.flatMap(curve => curve.points);
  const losses = all.map(([, loss]) => loss), top = Math.max(...losses), bottom = Math.min(...losses, top - 1);
  const last = Math.max(...all.map(([at]) => at), 1e-9);
  const x = at => 58 + (at / last) * (wide - 70), y = loss => 12 + ((top - loss) / (top - bottom)) * (high - 44);
  paint.scale(ratio, ratio);
  paint.strokeStyle = colour('--line');
  paint.fillStyle = colour('--text');
  paint.font = '12px system-ui, sans-serif';
  paint.textAlign = 'right';
  for (const loss of [top, (top + bottom) / 2, bottom]) {
    paint.beginPath();
    paint.moveTo(58, y(loss));
    paint.lineTo(wide - 12, y(loss));
    paint.stroke();
    paint.fillText(`${loss.toFixed(1)} dB`, 53, y(loss) + 4);
  }
  paint.textAlign = 'center';
  paint.fillText(label, wide / 2 + 20, high - 10);
  paint.lineWidth = 2;
  curves.forEach((curve, i) => {
    paint.strokeStyle = colourAt(i);
    paint.beginPath();
    curve.points.forEach(([at, loss], k) => (k === 0 ? paint.moveTo(x(at), y(loss)) : paint.lineTo(x(at), y(loss))));
    paint.stroke();
  });
  const one = curves[0].points;
  canvas.setAttribute('aria-label', `Loss: ${one[0][1].toFixed(1)} dB at the start, ${one.at(-1)[1].toFixed(1)} dB at the end`);
  canvas.dataset.points = String(all.length);
  $('curves').replaceChildren(...curves.filter(curve => curve.name).map((curve, i) => {
    const item = document.createElement('li');
    item.textContent = curve.name;
    item.style.setProperty('--mark', colourAt(i));
    return item;
  }));
}

/** Draws the curves again, after a change of the theme. */
export function redrawCurves() {
  if (shown) drawCurves(...shown);
}

// "loss -28.3 dB" as a number.
const decibels = status => Number(/(-?[\d.]+) dB/.exec(status)?.[1] ?? NaN);

/** @param progress what a running job has written (io/files/progress_file.h), or null */
export function showProgress(progress) {
  if (!progress) {
    if ($('progress-text').textContent) {
      $('progress-text').textContent = '';
      $('convergence-section').hidden = !$('convergence').dataset.isReport;
    }
    return;
  }
  $('convergence-section').hidden = false;
  $('convergence-section').open = true;
  $('progress-text').textContent =
    `${progress.stage}: ${Math.round(100 * progress.fraction)} %${progress.status ? `, ${progress.status}` : ''}`;
  const points = progress.history.map(([at, status]) => [100 * at, decibels(status)]).filter(([, loss]) => Number.isFinite(loss));
  $('convergence').hidden = points.length < 2;
  if (points.length > 1) drawCurves($('convergence'), [{ points }], '% of the iterations');
}

/** Draws the curves of a finished job. @param stages those of report.json */
export function showConvergence(stages) {
  const curves = stages.filter(stage => Array.isArray(stage.convergence)).map(stage => ({
    name: stage.stage,
    points: stage.convergence.map((loss, i) => [i, 10 * Math.log10(loss)]).filter(([, loss]) => Number.isFinite(loss)),
  })).filter(curve => curve.points.length > 1);
  if (curves.length === 0) return;
  $('convergence-section').hidden = $('convergence').hidden = false;
  $('convergence').dataset.isReport = '1';
  drawCurves($('convergence'), curves, 'iterations');
}
