"""A client of a Laconic node in plain Python: docs/wire.md in code. Needs python-can and cantools, nothing else.

    python reference_client.py --interface slcan --channel socket://127.0.0.1:PORT

opens a session, loads a TurtleBot3 Burger, drives it 200 steps in lockstep and then half a second in free run.
"""

import argparse
import secrets
import struct
import time
import zlib
from collections import Counter
from pathlib import Path

import can
import cantools

DBC = Path(__file__).with_name("laconic.dbc")
BASE = 0x680          # of the identifiers in the DBC
REPEAT_S = 0.1        # without an answer for this long, the same frame is sent again
MOTION = ("VOLTAGE", "VOLTAGE_FD", "RAW_INPUT", "RAW_INPUT_FD", "SYNC", "STEERING")
WHEEL_FIXED = 2
BURGER = {"MASS": 0.883, "YAW_INERTIA": 2.39e-3, "WHEEL_RADIUS": 0.033, "WHEEL_INERTIA": 2.07e-5, "MOTOR_GAIN": 0.125,
          "MOTOR_DAMPING": 0.235, "STEP": 0.01, "WHEEL_COUNT": 2, "WHEEL_KIND": [WHEEL_FIXED, WHEEL_FIXED],
          "WHEEL_X": [0.0, 0.0], "WHEEL_Y": [0.08, -0.08], "AXLE": [-1.5707963267949, -1.5707963267949]}


def crc(value, data, polynomial, bits):
    """The CRC register after these bytes, each with its highest bit first."""
    for byte in data:
        value ^= byte << bits - 8
        for _ in range(8):
            value = (value << 1 ^ (polynomial if value >> bits - 1 else 0)) & (1 << bits) - 1
    return value


def stir(x):
    """A bijection of 32 bits."""
    x ^= x >> 16
    x = x * 0xA5C6E92D & 0xFFFFFFFF
    x ^= x >> 15
    x = x * 0x816223D3 & 0xFFFFFFFF
    return x ^ x >> 16


def mix(a, b):
    """32 bits that depend on every bit of a and b."""
    return stir(stir(a ^ 0x6C61636F) ^ b)


def seal(message, data, count, key=None):
    """Writes counter and CRC into a payload: plain (key None), or by key and count."""
    listed = message.dbc.attributes["E2EDataID"].value
    chosen = None if key is None else mix(mix(key, message.frame_id - BASE), count)
    if message.is_fd:  # profile 5
        data[2] = count & 255
        data_id, start = int(listed, 16), 0xFFFF
        if chosen is not None:
            data_id, start = data_id + (chosen >> 16) & 0xFFFF, chosen & 0xFFFF
        data[:2] = struct.pack("<H", crc(start, data[2:] + struct.pack("<H", data_id), 0x1021, 16))
    else:              # profile 22
        data[1] = data[1] & 0xF0 | count & 15
        entry, start = (count & 15, 0xFF) if chosen is None else (chosen >> 8 & 15, chosen & 0xFF)
        data[0] = crc(start, data[1:] + bytes([bytes.fromhex(listed)[entry]]), 0x2F, 8) ^ 0xFF
    return data


class Client:
    """One session with one node."""

    def __init__(self, bus, dbc=DBC, base=BASE):
        self.bus, self.base, self.count, self.key, self.run_key, self.last = bus, base, Counter(), None, None, {}
        self.messages = {message.name: message for message in cantools.database.load_file(dbc).messages}
        self.by_id = {message.frame_id - BASE + base: message for message in self.messages.values()
                      if "E2EDataID" in message.dbc.attributes}  # frames of XCP have no protection

    def frame(self, name, count, key=None, **signals):
        """A frame, ready to be sent; signals that are not named are 0."""
        message = self.messages[name]
        data = bytearray(message.encode({s.name: 0 for s in message.signals} | signals, strict=False))
        return can.Message(arbitration_id=message.frame_id - BASE + self.base, is_extended_id=False,
                           is_fd=message.is_fd, bitrate_switch=message.is_fd, data=seal(message, data, count, key))

    def receive(self, seconds):
        """(name, signals) of the next right frame of the node; None when none comes in time."""
        end = time.monotonic() + seconds
        while (frame := self.bus.recv(max(0.0, end - time.monotonic()))) is not None:
            message, data = self.by_id.get(frame.arbitration_id), bytearray(frame.data)
            if message is None or "NODE" not in message.senders or len(data) != message.length:
                continue
            if data == seal(message, bytearray(data), data[2] if message.is_fd else data[1]):
                self.last[message.name] = message.decode(bytes(data))
                return message.name, self.last[message.name]
        return None

    def ask(self, frame, answer, seconds=2.0, **wanted):
        """Sends a frame, again and again, until its answer has come; TimeoutError when none comes."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self.bus.send(frame)
            again = time.monotonic() + REPEAT_S
            while (got := self.receive(again - time.monotonic())) is not None:
                if got[0] == answer and all(got[1][name] == value for name, value in wanted.items()):
                    return got[1]
        raise TimeoutError(f"no {answer} with {wanted} within {seconds} s")

    def open(self):
        """Waits for a frame of the node, then HELLO and OPEN: it stops its run and accepts this session only."""
        while self.receive(1.0) is None:
            print("waiting for a node")
        nonce = self.ask(self.frame("HELLO", 1), "CHALLENGE", request=1)["nonce"]
        session = secrets.randbits(32)
        hello = self.frame("OPEN", 1, nonce, nonce_echo=nonce & 0xFFFF, session=session)
        self.ask(hello, "RESULT", command="OPEN", request=1)
        self.key, self.count = mix(session, nonce), Counter()

    def command(self, name, **signals):
        """CONTROL, PARAMETER, COMMIT or SELECT; RuntimeError when the node refuses."""
        self.count[name] += 1
        frame = self.frame(name, self.count[name], self.key, **signals)
        result = self.ask(frame, "RESULT", command=signals.get("command", name), request=self.count[name] & 15)
        if result["status"] != "OK":
            raise RuntimeError(f"{name}: {result['status']}, {result['field']} {result['item']}")

    def load(self, parameters):
        """BEGIN, one PARAMETER after the other, COMMIT."""
        self.command("CONTROL", command="BEGIN")
        single, checksum, frames = self.last["IDENTITY"]["scalar_bytes"] == "SINGLE", 0, 0
        for field, value in parameters.items():
            for item, number in enumerate(value, 1) if isinstance(value, list) else [(0, value)]:
                words = [number] if isinstance(number, int) else struct.unpack(
                    "<I" if single else "<II", struct.pack("<f" if single else "<d", number))
                for upper, word in enumerate(words):
                    signals = {"field": field, "item": item, "value": word, "upper_half": upper}
                    payload = self.frame("PARAMETER", 0, **signals).data  # count 0: the CRC takes the lower half as 0
                    checksum, frames = zlib.crc32(payload[1:], checksum), frames + 1
                    self.command("PARAMETER", **signals)
        self.command("COMMIT", frame_count=frames, checksum=checksum)

    def start(self, command, **signals):
        """START_LOCKSTEP or START_FREE_RUN; motion frames are counted anew."""
        self.command("CONTROL", command=command, **signals)
        self.run_key = mix(self.key, self.count["CONTROL"] + 32)
        for name in MOTION:
            self.count[name] = 0

    def move(self, name, **signals):
        """A motion frame. The node does not act on the first of its kind after START, so it is sent twice."""
        for _ in range(2 if self.count[name] == 0 else 1):
            self.count[name] += 1
            self.bus.send(self.frame(name, self.count[name], self.run_key, **signals))

    def await_frame(self, name, seconds=1.0):
        """The next frame of that name."""
        while (got := self.receive(seconds)) is not None:
            if got[0] == name:
                return got[1]
        raise TimeoutError(f"no {name}: the node's last HEARTBEAT is {self.last['HEARTBEAT']}")


def main():
    """The example."""
    parser = argparse.ArgumentParser(description="drives a Laconic node")
    parser.add_argument("--interface", default="slcan")
    parser.add_argument("--channel", required=True)
    words = parser.parse_args()
    with can.Bus(interface=words.interface, channel=words.channel) as bus:
        client = Client(bus)
        client.open()
        client.load(BURGER)
        client.command("SELECT", send_pose=1)
        client.start("START_LOCKSTEP")
        for _ in range(200):
            client.move("VOLTAGE", sync=1, voltage_1=5.5, voltage_2=10.0)
            pose = client.await_frame("POSE")
        print(f"lockstep: after 2 s at x = {pose['x']:.3f} m, y = {pose['y']:.3f} m, heading {pose['heading']:.3f} rad")
        client.command("CONTROL", command="STOP")
        client.command("CONTROL", command="RESET")
        client.start("START_FREE_RUN", rate=100, watchdog=200)
        for _ in range(50):
            client.move("VOLTAGE", voltage_1=5.5, voltage_2=10.0)
            pose = client.await_frame("POSE")
        client.command("CONTROL", command="STOP")
        print(f"free run: after 50 poses at x = {pose['x']:.3f} m, y = {pose['y']:.3f} m")


if __name__ == "__main__":
    main()
