"""The kinds of faults that drives have on purpose, and their bits in the order to a node."""

STALL, BUS_OFF, SILENT, ERROR_FRAMES = "stall", "bus-off", "silent", "error-frames"
ORDERS = {STALL: 1024, "encoder": 1, "temperature": 4, "overspeed": 8, "supply": 16, BUS_OFF: 256, SILENT: 512}
OF_DRIVE = tuple(kind for kind, bit in ORDERS.items() if bit < 256)  # LACONIC_DRIVE_FAULT_…; the rest ORDER_…
OF_WHEEL = (STALL, *OF_DRIVE)  # what concerns no bus
KINDS = (*ORDERS, ERROR_FRAMES)
