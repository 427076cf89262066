"""A batch on a GPU: the core's own text, compiled for the device when the program runs; docs/gpu.md."""

from laconic.gpu.lanes import Gpu as Gpu
