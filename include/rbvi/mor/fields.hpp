// The primal basis as fields on the whole mesh, in the numbers of the undistributed mesh: for
// pictures and errors of the displacement, not for answers. It is as large as the mesh times the
// basis, so that no rank holds all of it: it goes to its file by blocks of rows.
#pragma once

#include "rbvi/fem/problem.hpp"
#include "rbvi/model/model.hpp"
#include "rbvi/mor/pod.hpp"

#include <filesystem>

namespace rbvi {

/// Collective. Points, cells and imposed values of the mesh into the model of the first rank.
void gather_mesh(const Problem &problem, ReducedModel &model);

/// Tells a basis from others by its values at some vectors, agreed by all ranks. Collective.
std::string key_of_fields(const Problem &problem, const LinearBasis &basis);

/// Collective. Writes the fields of `model`, whose fields_key is that of the basis, beside the file
/// of the model. Throws failure.
void write_fields(const Problem &problem, const LinearBasis &basis, const ReducedModel &model,
                  const std::filesystem::path &model_path);

/// Collective. The same into the model, on every rank: for meshes that are small.
void gather_fields(const Problem &problem, const LinearBasis &basis, ReducedModel &model);

} // namespace rbvi
