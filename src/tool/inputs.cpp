#include "rbvi/par/collective.hpp"
#include "rbvi/tool/case_file.hpp"
#include "rbvi/tool/options.hpp"

#include "rbvi/core/error.hpp"

#include <fstream>

namespace rbvi {

namespace {

/// A run leaves its own case file, which may be the one that another run left there.
void check_case_of_run(const RunFiles &files) {
  if (files.case_name.empty() || files.out.empty()) return;
  std::string first_line;
  std::getline(std::ifstream(files.case_name) >> std::ws, first_line);
  if (first_line == run_case_header) return;
  check_overwriting({"-out " + files.out.string() + ": its", case_of_run(files.out)},
                    {{"the case file", files.case_name}});
}

} // namespace

void check_outputs(MPI_Comm comm, const RunFiles &files, const std::string &mesh_file,
                   const std::vector<NamedFile> &outputs) {
  std::vector<NamedFile> inputs{{"the case file", files.case_name},
                                {"the file of -mesh", mesh_file}};
  for (const auto &[name, file] : files.set_files)
    inputs.push_back({"the file of -" + name, file});
  collectively(comm, [&] {
    for (std::size_t i = 0; i < outputs.size(); ++i) {
      check_overwriting(outputs[i], inputs);
      check_overwriting(outputs[i], {outputs.begin(), outputs.begin() + static_cast<long>(i)});
    }
    check_case_of_run(files);
  });
}

} // namespace rbvi
