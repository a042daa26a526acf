// How HDF5 is used: quietly, and without its clean-up at the end.
#pragma once

namespace rbvi {

/// Errors of HDF5 come back as ours, and it does nothing at the end of the program, where it would
/// crash over a file that a full disk has left half written. Under MPI that holds only where this
/// is called before MPI is initialised. Readers and writers call it, too.
void start_hdf5();

} // namespace rbvi
