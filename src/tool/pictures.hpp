// What cases/figures.py draws of a model beside its errors.
#pragma once

#include "rbvi/model/model.hpp"

#include <filesystem>

namespace rbvi {

/// Into the directory `out`: along.csv, reduced outputs along each free parameter through the
/// middle of the box, as many rows for each one after the other; stresses.csv, what the contacts
/// carry at the middle and at those of `set` where the normal force is least and largest; u.vtu
/// with its contact files, the answer at the middle. `outputs`: of the set. Where there is no
/// answer there are no rows, or no file. Serial.
void write_pictures(const ReducedModel &model, const std::vector<Mu> &set,
                    const std::vector<Outputs> &outputs, const std::filesystem::path &out);

} // namespace rbvi
