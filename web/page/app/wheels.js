// A scene's wheels: what belongs to one comes and goes with it.

const OF_A_WHEEL = /^(voltage_V|axle_torque_Nm)\[(\d+)\]$/;

const NEXT_M = 0.05;

/** The place, or one to the right of it where no wheel is: on another one a wheel would not be seen. */
export function freePlace(/** @type {any[]} */ wheels, /** @type {number[]} */ [x, y]) {
  const isTaken = () => wheels.some((each) => Math.hypot(each.x_m - x, each.y_m - y) < NEXT_M / 2);
  for (let tries = 0; tries < wheels.length && isTaken(); tries++) y -= NEXT_M;
  return [x, y];
}

export function addToWheels(/** @type {any} */ scene, /** @type {any} */ wheel) {
  scene.vehicle.wheel.push(wheel);
  scene.initial?.wheel_speed_rad_per_s?.push(0);
}

/** Takes a wheel out, with its inputs and its speed at the start; those of later wheels move up. */
export function takeFromWheels(/** @type {any} */ scene, /** @type {number} */ index) {
  scene.vehicle.wheel.splice(index, 1);
  scene.initial?.wheel_speed_rad_per_s?.splice(index, 1);
  scene.input = scene.input
    .filter((/** @type {any} */ { signal }) => Number(OF_A_WHEEL.exec(signal)?.[2]) !== index + 1)
    .map((/** @type {any} */ each) => ({ ...each, signal: movedUp(each.signal, index + 1) }));
}

function movedUp(/** @type {string} */ signal, /** @type {number} */ beyond) {
  const [, name, number] = OF_A_WHEEL.exec(signal) ?? [];
  return name && Number(number) > beyond ? `${name}[${Number(number) - 1}]` : signal;
}
