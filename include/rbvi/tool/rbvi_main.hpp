// rbvi: the MPI tool. `rbvi -help` lists commands and options.
#pragma once

#include "rbvi/core/scene.hpp"

namespace rbvi {

/// The whole program, for the scenes of the registry. Starts and ends MPI and PETSc; returns the
/// exit status. Collective.
int rbvi_main(int argc, char **argv, const Registry &registry);

} // namespace rbvi
