// Geometries of Gmsh, meshed by the program gmsh.
#pragma once

#include <mpi.h>

#include <filesystem>
#include <map>
#include <string>

namespace rbvi {

/// A text as one word of a shell.
std::string in_shell_quotes(const std::string &text);

/// Where meshes of geometries are kept that belong to no run: a folder of this user.
std::filesystem::path folder_of_meshes();

/// The mesh of dimension `dim` that gmsh makes of a .geo with these numbers set, FOLDER/<hash of
/// mesh and numbers>.msh: made at each call, so that it is that of all files that the geometry
/// includes as they are. Throws bad_input without the program gmsh, with what gmsh says, and for a
/// number that the geometry does not have or sets by itself. Collective.
std::string meshed(MPI_Comm comm, const std::string &geo, int dim,
                   const std::map<std::string, double> &numbers,
                   const std::filesystem::path &folder);

} // namespace rbvi
