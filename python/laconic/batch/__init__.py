"""Many vehicles side by side, each with the bits of one: laconic/batch.h on numpy arrays."""

from laconic.batch.hinges import ArticulatedBatch as ArticulatedBatch
from laconic.batch.lanes import Batch as Batch
