// Which cells the largest and smallest values of a model are taken from.
#pragma once

#include "rbvi/element/output_cells.hpp"
#include "rbvi/sweep/sweep.hpp"

namespace rbvi {

/// Of the cells that outputs are taken from, those that a largest or smallest value over a region
/// or boundary may be in: where the value at some sample is within a quarter of the range over the
/// cells of the extreme one; whatever other outputs need stays. All where nothing is extreme.
/// verify compares with all cells. Collective on `comm`, which must share the samples.
OutputCells candidate_cells(MPI_Comm comm, const Scene &scene, const OutputCells &cells,
                            const std::vector<Sample> &samples);

} // namespace rbvi
