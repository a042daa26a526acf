// Geometries of Gmsh, meshed by the program gmsh.
#pragma once

#include <mpi.h>

#include <filesystem>
#include <map>
#include <string>

namespace rbvi {

/// The mesh FOLDER/<hash>.msh of a .geo with these numbers set; made where it is not there yet.
/// Throws bad_input without the program gmsh, or with what gmsh says. Collective.
std::string meshed(MPI_Comm comm, const std::string &geo,
                   const std::map<std::string, double> &numbers,
                   const std::filesystem::path &folder);

} // namespace rbvi
