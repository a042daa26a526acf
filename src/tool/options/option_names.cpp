// Names of options: which there are, and what to say of others.
#include "database.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"

#include <algorithm>

namespace rbvi {

namespace {

/// Options of PETSc objects, and how ours of that kind begin.
struct Kind {
  const char *begin;
  std::vector<std::string> prefixes;
};

const std::vector<Kind> &kinds() {
  static const std::vector<Kind> all{{"ksp_", {"hf_", "v_", "vi_", "nitsche_"}},
                                     {"pc_", {"hf_", "v_", "vi_", "nitsche_"}},
                                     {"mat_", {"hf_", "v_", "vi_", "nitsche_"}},
                                     {"snes_", {"vi_", "nitsche_"}},
                                     {"sub_", {}},
                                     {"vec_", {}},
                                     {"dm_", {}},
                                     {"eps_", {"pga_", "infsup_"}},
                                     {"svd_", {"pga_", "infsup_"}},
                                     {"st_", {}},
                                     {"bv_", {}},
                                     {"ds_", {}},
                                     {"tao_", {}},
                                     {"ts_", {}},
                                     {"is_", {}}};
  return all;
}

/// Of PETSc itself, those that serve here.
const std::vector<std::string> petsc_names{"log_view",     "log_trace",    "info",
                                           "malloc_debug", "malloc_dump",  "options_left",
                                           "options_view", "options_file", "fp_trap"};

bool is_flag(const std::string &name) {
  return std::any_of(tool_options().begin(), tool_options().end(), [&](const OptionHelp &o) {
    return o.name == name && (o.default_value == "yes" || o.default_value == "no");
  });
}

/// What to do about a name that nothing knows.
std::string advice(const std::string &name, std::vector<std::string> known) {
  for (const Kind &kind : kinds()) {
    if (!name.starts_with(kind.begin)) continue;
    if (kind.prefixes.empty())
      return "no object of rbvi takes PETSc's options -" + std::string(kind.begin) + "*";
    std::string all;
    for (const std::string &prefix : kind.prefixes)
      all += (all.empty() ? "-" : ", -") + prefix + name;
    return "PETSc's options need the prefix of a solver: " + all;
  }
  known.insert(known.end(), petsc_names.begin(), petsc_names.end());
  return "the nearest one is -" + nearest_name(name, known) + " (-help lists all)";
}

} // namespace

void check_names(const std::vector<std::string> &names, const Origin &origin, const Scene &scene) {
  std::vector<std::string> known;
  for (const OptionHelp &option : tool_options())
    known.push_back(option.name);
  for (const auto &[name, value] : scene.options)
    known.push_back(name);
  for (const Parameter &parameter : scene.parameters.all)
    known.push_back(parameter.name);
  for (const std::string &name : names) {
    const auto found = origin.find(name);
    const std::string where = found == origin.end() ? "" : found->second;
    if (starts_with_any(name, solver_prefixes())) continue;
    if (!contains(known, name))
      throw bad_input("unknown option -" + name + where + ": " + advice(name, known));
    if (!is_flag(name) && text_of(name).empty())
      throw bad_input("option -" + name + where + " has no value");
  }
}

} // namespace rbvi
