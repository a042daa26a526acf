// Files on their way to their name (see write_atomically): what they are called, what a process
// that ends early does about them, and how those of processes that were killed go away.
#pragma once

#include <chrono>
#include <filesystem>
#include <string>

namespace rbvi {

/// "<path>.tmp.<hash of the host's name>.<process>.<attempt>"
std::filesystem::path temporary_name(const std::filesystem::path &path, int attempt);

/// Removes the temporary files in `directory`, those of file `of` alone where it is named, whose
/// process no longer runs on this host. Those of other hosts stay: nobody can tell. Does nothing
/// where there is no such directory.
void remove_stale_temporaries(const std::filesystem::path &directory, const std::string &of = "");

/// For a process that another of its threads is about to end: lets the file that is being written
/// come to its name, for at most `patience`, and no other be begun. False if time ran out: then it
/// may be called again.
bool stop_writing(std::chrono::milliseconds patience);

} // namespace rbvi
