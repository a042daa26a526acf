// A model as a unit of co-simulation, FMI 2.0: a ZIP archive of modelDescription.xml, a library
// (src/bin/fmu.cpp) and the image of the model.
//
// Value references of reals, for P parameters and O outputs:
//   0 ... P-1            the parameters, which are inputs
//   P ... P+O-1          the outputs
//   P+O ... P+2O-1       the largest error of each output, where one was measured; not of checks
//   P+2O                 the residual
// Of integers: 0, the status of the answer (rbvi_status of rbvi.h).
#pragma once

#include "rbvi/model/model.hpp"

#include <filesystem>
#include <string>

namespace rbvi {

/// Where the library is: beside the program that runs, or where a build or an install has it.
/// Throws failure.
std::filesystem::path library_of_units();

/// modelDescription.xml. `guid`: of the image of the model.
std::string model_description(const ReducedModel &model, const std::string &guid);

/// The bytes of the archive, without the fields of the model. Throws bad_input for a model of a
/// program's scene, which the library does not have.
std::string fmu_of(const ReducedModel &model, const std::filesystem::path &library);

} // namespace rbvi
