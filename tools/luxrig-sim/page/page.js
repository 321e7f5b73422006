// The page of luxrig-sim. Rows are made once from GET /rig and /truth, then only their numbers change. Every text is put
// in as text. The routes: API.md.
const $ = (selector) => document.querySelector(selector);

function element(name, properties = {}, ...children) {
  const made = Object.assign(document.createElement(name), properties);
  made.append(...children);
  return made;
}

function setText(node, text) {
  if (node.textContent !== text) node.textContent = text;
}

const lux = (value) => value.toFixed(value >= 100 ? 0 : value >= 10 ? 1 : 2);
const percent = (value) => `${(100 * value).toFixed(value > 0 && value < 0.1 ? 1 : 0)}\u00a0%`;

function tell(what) {
  $('#refused').hidden = !what;
  setText($('#refused'), what);
}

/** Changes on their way, and all so far: a truth that was asked for before the last of them would undo it on the page. */
let pending = 0;
let changes = 0;

/** Sends it; shows why if it is refused. */
async function post(route, body) {
  ++pending;
  ++changes;
  try {
    const options = { method: 'POST' };
    if (body) Object.assign(options, { headers: { 'Content-Type': 'application/json' }, body: JSON.stringify(body) });
    const answer = await fetch(route, options);
    tell(answer.ok ? '' : (await answer.json()).error);
  } catch {
    tell('The simulator does not answer.');
  }
  --pending;
  await show();
}

/** A slider that posts a share of light. While a finger is on it, the truth does not move it. */
function shareSlider(label, onSet) {
  const input = element('input', { type: 'range', min: 0, max: 100, step: 5, value: 100, ariaLabel: label });
  const output = element('output', {}, '100 %');
  let held = false;
  input.addEventListener('pointerdown', () => (held = true));
  for (const end of ['pointerup', 'pointercancel', 'blur']) input.addEventListener(end, () => (held = false));
  input.addEventListener('input', () => setText(output, percent(input.value / 100)));
  input.addEventListener('change', () => void onSet(Number(input.value) / 100));
  return {
    root: element('div', { className: 'share' }, input, output),
    show(share) {
      if (held) return;
      input.value = Math.round(100 * share);
      setText(output, percent(share));
    },
  };
}

function copyButton(text) {
  const button = element('button', { type: 'button', ariaLabel: `copy ${text}` }, 'Copy');
  button.addEventListener('click', async () => {
    try {
      await navigator.clipboard.writeText(text);
      setText(button, 'Copied');
    } catch {
      setText(button, 'Select it by hand');
    }
    setTimeout(() => setText(button, 'Copy'), 1500);
  });
  return button;
}

const listed = (values) => values.join(', ');

function busItem(bus) {
  const place = bus.path ?? `${bus.host}:${bus.port}`;
  const says = bus.host === '0.0.0.0' ? ['on every address of this computer'] : [];
  if (bus.universes) says.push(`${bus.universes.length > 1 ? 'universes' : 'universe'} ${listed(bus.universes)}`);
  if (bus.units) says.push(`${bus.units.length > 1 ? 'units' : 'unit'} ${listed(bus.units)}`);
  if (bus.nodes) says.push(`nodes ${listed(bus.nodes)}`);
  if (bus.multicast) says.push(`multicast ${listed(bus.multicast)}`);
  return element(
      'li', { className: 'bus' }, element('strong', {}, `${bus.name}: ${bus.protocol}`),
      element('div', { className: 'place' }, element('code', {}, place), copyButton(place)),
      element('span', { className: 'quiet' }, says.join('; ')));
}

function whereOf(device) {
  if (device.universe !== undefined) {
    const last = device.address + device.slots - 1;
    return `${device.bus}, universe ${device.universe}, ${
        device.slots > 1 ? `slots ${device.address} to ${last}` : `slot ${device.address}`}`;
  }
  const register = device.register ?? device.input_register ?? device.coil;
  let kind = device.input_register === undefined ? 'register' : 'input register';
  if (device.coil !== undefined) kind = 'coil';
  const range = device.full !== undefined ? `, ${device.dark} to ${device.full}` : '';
  const count = device.lux_per_count !== undefined ? `, ${device.lux_per_count} lx a count` : '';
  const order = device.word_order ? ', low word first' : '';
  return `${device.bus}, unit ${device.unit}, ${kind} ${register}${device.type ? `, ${device.type}` : ''}${order}${
      range}${count}`;
}

const named = (name, where) =>
    element('th', { scope: 'row' }, name, ...(where ? [element('span', { className: 'where quiet' }, where)] : []));

/** Rows by position in the lists of /truth, which never change their order. */
const rows = { points: [], fixtures: [], luxmeters: [] };
let daylight;

function makeRows(rig, truth) {
  for (const point of truth.points) {
    const cells =
        [element('td'), element('td'), element('td', {}, point.max_lux === undefined ? '–' : lux(point.max_lux))];
    const slider =
        shareSlider(`light let through to ${point.name}`, (value) => post('/shade', { point: point.name, value }));
    $('#points tbody').append(element('tr', {}, named(point.name), ...cells, element('td', {}, slider.root)));
    rows.points.push({ cells, slider });
  }
  truth.luxmeters.forEach((meter, i) => {
    const cells = [element('td'), element('td')];
    const slider =
        shareSlider(`light let through to ${meter.name}`, (value) => post('/cover', { luxmeter: meter.name, value }));
    $('#luxmeters tbody')
        .append(
            element('tr', {}, named(meter.name, whereOf(rig.luxmeters[i])), ...cells, element('td', {}, slider.root)));
    rows.luxmeters.push({ cells, slider });
  });
  truth.fixtures.forEach((fixture, i) => {
    const text = element('span');
    const bar = element('i');
    const cells = [element('td'), element('td', {}, text, element('span', { className: 'bar' }, bar)), element('td')];
    $('#fixtures tbody').append(element('tr', {}, named(fixture.name, whereOf(rig.fixtures[i])), ...cells));
    rows.fixtures.push({ cells, text, bar });
  });
  if (truth.daylight !== undefined) {
    const input =
        element('input', { type: 'number', min: 0, max: 1000, step: 0.1, value: truth.daylight, id: 'daylight-value' });
    input.addEventListener('change', () => void post('/daylight', { value: input.valueAsNumber }));
    $('#daylight')
        .append(element('label', { htmlFor: 'daylight-value' }, 'Daylight, times that of the rig file: '), input);
    $('#daylight').hidden = false;
    daylight = input;
  }
  if (!truth.fixtures.some((fixture) => fixture.pan_deg !== undefined))
    for (const cell of document.querySelectorAll('#fixtures tr > :nth-child(4)')) cell.hidden = true;
  for (const id of ['luxmeters', 'fixtures', 'points']) $(`#${id}`).hidden = truth[id].length === 0;
}

/** Switches of a device, made when it is opened first. */
const switches = new Map();
const key = (device, fault) => JSON.stringify([device, fault]);

function deviceDetails(device, faults) {
  const details = element(
      'details', {}, element('summary', {}, device.name, element('span', { className: 'quiet' }, `  ${device.kind}`)));
  details.addEventListener('toggle', () => {
    if (details.childElementCount > 1) return;
    for (const name of device.faults) {
      const fault = faults.find((known) => known.name === name);
      const box = element('input', { type: 'checkbox' });
      const row = element(
          'div', { className: 'switch' },
          element('label', {}, box, element('span', {}, name, element('span', { className: 'quiet' }, fault.does))));
      let value;
      if (fault.least !== undefined) {
        value = element('input', {
          type: 'number',
          min: fault.least,
          max: fault.most,
          step: 'any',
          value: fault.default,
          ariaLabel: `value of ${name}`
        });
        row.append(value);
      }
      const send = async () => {
        const body = { device: device.name, fault: name, on: box.checked };
        if (value && Number.isFinite(value.valueAsNumber)) body.value = value.valueAsNumber;
        await post('/fault', body);
      };
      box.addEventListener('change', () => void send());
      value?.addEventListener('change', () => box.checked && void send());
      switches.set(key(device.name, name), { box, value });
      details.append(row);
    }
    showFaults(shown);
  });
  return details;
}

let shown = [];
function showFaults(on) {
  const changed = JSON.stringify(on) !== JSON.stringify(shown);
  shown = on;
  const live = new Map(on.map((fault) => [key(fault.device, fault.fault), fault]));
  for (const [which, { box, value }] of switches) {
    box.checked = live.has(which);
    const held = live.get(which)?.value;
    if (value && held !== undefined && document.activeElement !== value) value.value = held;
  }
  if (!changed) return;
  $('#no-faults').hidden = on.length > 0;
  $('#faults-on').replaceChildren(...on.map((fault) => {
    const button = element('button', { type: 'button', ariaLabel: `end ${fault.fault} of ${fault.device}` }, 'End');
    button.addEventListener('click', () => void post('/fault', { device: fault.device, fault: fault.fault, on: false }));
    return element(
        'li', { className: 'on' },
        element('span', {}, `${fault.device}: ${fault.fault}${fault.value === undefined ? '' : ` ${fault.value}`}`),
        button);
  }));
}

/** A picture in the format PFM, as width, height and red, green, blue from above. */
function readPfm(buffer) {
  const bytes = new Uint8Array(buffer);
  let at = 0;
  const word = () => {
    let text = '';
    while (at < bytes.length && bytes[at] > 32) text += String.fromCharCode(bytes[at++]);
    ++at;
    return text;
  };
  const [kind, width, height, scale] = [word(), Number(word()), Number(word()), Number(word())];
  const channels = kind === 'PF' ? 3 : 1;
  const view = new DataView(buffer, at);
  if (!(width > 0 && height > 0) || view.byteLength < 4 * width * height * channels) throw new Error('no PFM');
  return {
    width,
    height,
    value: (x, y, c) =>
        view.getFloat32(4 * (((height - 1 - y) * width + x) * channels + (channels === 3 ? c : 0)), scale < 0)
  };
}

/** Draws it so that all but the brightest hundredth of its pixels have their true relation. */
function draw(picture, canvas) {
  const { width, height, value } = picture;
  const brightness = new Float32Array(width * height);
  for (let i = 0; i < brightness.length; ++i) brightness[i] = value(i % width, Math.floor(i / width), 1);
  brightness.sort();
  const white = Math.max(brightness[Math.floor(0.99 * (brightness.length - 1))], 1e-6);
  Object.assign(canvas, { width, height });
  const context = canvas.getContext('2d');
  const image = context.createImageData(width, height);
  for (let i = 0; i < width * height; ++i) {
    for (let c = 0; c < 3; ++c) {
      const linear = Math.min(Math.max(value(i % width, Math.floor(i / width), c) / white, 0), 1);
      image.data[4 * i + c] = 255 * (linear <= 0.0031308 ? 12.92 * linear : 1.055 * linear ** (1 / 2.4) - 0.055);
    }
    image.data[4 * i + 3] = 255;
  }
  context.putImageData(image, 0, 0);
  return white;
}

function cameraItem(name) {
  const button = element('button', { type: 'button' }, `Take a picture with ${name}`);
  const says = element('span', { className: 'quiet' });
  const canvas = element('canvas', { hidden: true, ariaLabel: `picture of ${name}` });
  button.addEventListener('click', async () => {
    button.disabled = true;
    setText(says, ' takes seconds…');
    try {
      const answer = await fetch(`/picture?camera=${encodeURIComponent(name)}`);
      if (!answer.ok) throw new Error((await answer.json()).error);
      const white = draw(readPfm(await answer.arrayBuffer()), canvas);
      canvas.hidden = false;
      setText(says, ` white is ${white.toPrecision(2)} cd/m²`);
    } catch (error) {
      setText(says, ` ${error.message}`);
    }
    button.disabled = false;
  });
  return element('div', {}, button, says, canvas);
}

function showTruth(truth) {
  truth.points.forEach((point, i) => {
    const { cells, slider } = rows.points[i];
    const over = (value) => point.max_lux !== undefined && value > point.max_lux;
    setText(cells[0], over(point.lux) ? `${lux(point.lux)} over` : lux(point.lux));
    setText(cells[1], lux(point.max_lux_seen));
    cells[0].className = over(point.lux) ? 'over' : '';
    cells[1].className = over(point.max_lux_seen) ? 'over' : '';
    slider.show(point.shade ?? 1);
  });
  truth.luxmeters.forEach((meter, i) => {
    const { cells, slider } = rows.luxmeters[i];
    setText(cells[0], lux(meter.lux));
    setText(cells[1], lux(meter.shown));
    slider.show(meter.cover ?? 1);
  });
  truth.fixtures.forEach((fixture, i) => {
    const { cells, text, bar } = rows.fixtures[i];
    setText(cells[0], percent(fixture.drive));
    setText(text, percent(fixture.level));
    bar.style.width = `${Math.min(100, 100 * fixture.level)}%`;
    if (fixture.pan_deg === undefined) return setText(cells[2], '–');
    const beam = fixture.beam_angle_deg === undefined ? '' : `, beam ${fixture.beam_angle_deg.toFixed(0)}°`;
    setText(cells[2], `pan ${fixture.pan_deg.toFixed(1)}°, tilt ${fixture.tilt_deg.toFixed(1)}°${beam}`);
  });
  if (daylight && document.activeElement !== daylight) daylight.value = truth.daylight;
  const worst = truth.violations.slice(-5);
  const told = worst.map((v) => `${v.point}: ${lux(v.lux)} lx at ${v.time_s.toFixed(0)} s, limit ${lux(v.max_lux)} lx`);
  const list = $('#violations');
  if (list.dataset.told !== told.join('\n')) {
    list.dataset.told = told.join('\n');
    list.replaceChildren(...told.map((text) => element('li', { className: 'over' }, text)));
  }
  showFaults(truth.faults);
  const times = truth.violations.length;
  setText($('#line'), `live, ${truth.time_s.toFixed(1)} s${times > 0 ? `; ${times} times over a limit` : ''}`);
  $('#line').classList.remove('lost');
}

async function ask(route) {
  const answer = await fetch(route);
  if (!answer.ok) throw new Error(`${route}: ${answer.status}`);
  return answer.json();
}

async function show() {
  const before = changes;
  try {
    const truth = await ask('/truth');
    if (pending === 0 && before === changes) showTruth(truth);
  } catch {
    setText($('#line'), 'The simulator does not answer.');
    $('#line').classList.add('lost');
  }
}

async function start() {
  const [rig, truth] = await Promise.all([ask('/rig'), ask('/truth')]);
  document.title = `${rig.rig} · simulated rig`;
  setText($('#rig'), rig.rig);
  setText(
      $('#summary'),
      `simulated rig, seed ${rig.seed}: ${truth.points.length} points, ${truth.fixtures.length} fixtures, ${
          truth.luxmeters.length} luxmeters`);
  $('#buses .list').append(...rig.buses.map(busItem));
  makeRows(rig, truth);
  $('#devices').append(...rig.devices.map((device) => deviceDetails(device, rig.faults)));
  $('#camera-list').append(...rig.cameras.map(cameraItem));
  $('#cameras').hidden = rig.cameras.length === 0;
  $('#clear-faults').addEventListener('click', () => void post('/clear_faults'));
  $('#reset-peaks').addEventListener('click', () => void post('/reset_peaks'));
  showTruth(truth);
  document.body.classList.add('ready');
  for (;;) {
    await new Promise((resolve) => setTimeout(resolve, 400));
    if (!document.hidden) await show();
  }
}

/** Until the simulator answers for the first time. */
async function begin() {
  try {
    await start();
  } catch (error) {
    setText($('#line'), `The simulator does not answer (${error.message}); trying again.`);
    $('#line').classList.add('lost');
    setTimeout(() => location.reload(), 2000);
  }
}
void begin();
