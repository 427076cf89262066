"""The main job: one scene through core, FMUs and node, compared bit for bit and with an independent reference."""
