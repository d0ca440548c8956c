// The progress of a job that is still running, with the loss of its iterations.

const $ = id => document.getElementById(id);

/** @param progress what the job has written: {stage, fraction, status, seconds, curve: [[fraction, dB], …]}; or nothing */
export function showProgress(progress) {
  const has = Boolean(progress);
  $('convergence-section').hidden = !has;
  if (!has) return;
  $('convergence-section').open = true;
  $('progress-text').textContent = `${progress.stage}: ${Math.round(100 * progress.fraction)} %${progress.status ? `, ${progress.status}` : ''}`;
  const canvas = $('convergence'), paint = canvas.getContext('2d'), curve = progress.curve ?? [];
  canvas.hidden = curve.length < 2;
  if (curve.length < 2) return;
  const losses = curve.map(([, loss]) => loss), high = Math.max(...losses), low = Math.min(...losses, high - 1);
  const x = i => 44 + (curve[i][0] / Math.max(curve.at(-1)[0], 1e-9)) * (canvas.width - 56);
  const y = loss => 14 + ((high - loss) / (high - low)) * (canvas.height - 40);
  paint.fillStyle = '#10131a';
  paint.fillRect(0, 0, canvas.width, canvas.height);
  paint.strokeStyle = '#3a4252';
  paint.fillStyle = '#c6cede';
  paint.font = '11px system-ui, sans-serif';
  for (const loss of [high, (high + low) / 2, low]) {
    paint.beginPath();
    paint.moveTo(44, y(loss));
    paint.lineTo(canvas.width - 12, y(loss));
    paint.stroke();
    paint.fillText(`${loss.toFixed(1)} dB`, 2, y(loss) + 4);
  }
  paint.fillText('iterations', canvas.width / 2 - 20, canvas.height - 8);
  paint.strokeStyle = '#8ea6ff';
  paint.lineWidth = 2;
  paint.beginPath();
  curve.forEach(([, loss], i) => (i === 0 ? paint.moveTo(x(i), y(loss)) : paint.lineTo(x(i), y(loss))));
  paint.stroke();
  canvas.setAttribute('aria-label', `Loss: ${losses[0].toFixed(1)} dB at the start, ${losses.at(-1).toFixed(1)} dB now`);
  canvas.dataset.points = String(curve.length);
}
