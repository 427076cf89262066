"""A recorded run of a real robot against the model: rolled distance, friction, predicted transients and currents."""
