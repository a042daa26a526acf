// One committed sample.
#pragma once

#include "rbvi/sweep/sweep.hpp"

namespace rbvi {

void write_sample(const std::filesystem::path &path, const Sample &sample,
                  const Settings &settings);

/// Throws bad_input if the file was made with other settings, naming one of them, or by another
/// version; DamagedFile if it is not what was written under its name.
Sample read_sample(const std::filesystem::path &path, const Settings &settings);

} // namespace rbvi
