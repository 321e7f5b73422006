/** Wires the live status to the views. */

import { fetchRoom, type Status } from './api';
import { element } from './dom';
import { follow } from './live';
import {RoomCard} from './room/room_card';
import { Selection } from './selection';
import {AccessView} from './views/access';
import { AlarmsView } from './views/alarms';
import { ByHandView } from './views/by_hand';
import { DevicesView, MetersView } from './views/devices';
import { FixturesView } from './views/fixtures';
import { HeaderView } from './views/header';
import {OutputView} from './views/output';
import { PointsTable } from './views/points_table';
import {QuestionView} from './views/question';
import {SolveView} from './views/solve';
import { themeButton } from './views/theme';
import { TilesView } from './views/tiles';

const selection = new Selection();
const header = new HeaderView(themeButton());
const access = new AccessView();
const alarms = new AlarmsView();
const question = new QuestionView();
const tiles = new TilesView();
const room = new RoomCard(selection);
const solve = new SolveView();
const points = new PointsTable(selection);
const fixtures = new FixturesView(selection);
const byHand = new ByHandView();
const meters = new MetersView();
const devices = new DevicesView();
const output = new OutputView();

const main = element(
    'main',
    {},
    element('div', {class: 'column wide'}, room.root, solve.root, points.root),
    element(
        'div', {class: 'column'}, tiles.root, fixtures.root, byHand.root, meters.root, devices.root, access.log,
        output.root),
);
document.getElementById('app')!.replaceChildren(header.root, alarms.root, access.root, question.root, main);

/** The room is asked for until it is there, and again when the daemon turns out to be another or a newer one. */
let roomOf: string | undefined;
let asking = false;
let uptime_s = -1;
async function wantRoom(status: Status): Promise<void> {
  const restarted = status.time_s !== undefined && status.time_s < uptime_s;
  uptime_s = status.time_s ?? uptime_s;
  if (restarted) roomOf = undefined;
  if (asking || roomOf === status.rig) return;
  asking = true;
  try {
    const found = await fetchRoom();
    if (found) {
      room.setRoom(found);
      roomOf = status.rig;
    }
  } catch {
    // The line is down; the next status asks again.
  } finally {
    setTimeout(() => (asking = false), 1000);
  }
}

follow(
  (status) => {
    header.show(status);
    alarms.show(status.alarms);
    question.show(status.question);
    tiles.show(status);
    room.show(status);
    solve.show(status);
    points.show(status.points);
    fixtures.show(status.fixtures);
    byHand.show(status);
    meters.show(status.luxmeters);
    devices.show(status.devices);
    output.show(status.output);
    document.body.classList.toggle('dark-stage', status.blackout);
    document.body.classList.toggle('is-asked', status.question !== undefined);
    document.body.classList.add('ready');
    void wantRoom(status);
  },
  (line) => {
    header.showLine(line);
    alarms.showLine(line);
    access.showLine(line);
    document.body.classList.toggle('stale', line.state !== 'live');
  },
);
