// Options of SLEPc's objects: which there are, and whether a run asks for them.
#include "database.hpp"
#include "table.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/mor/high_fidelity_pair.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/par/small_svd.hpp"

#include <algorithm>
#include <cstdio>
#include <set>

namespace rbvi {

namespace {

/// Which values: all of a small matrix, the smallest of a large one.
bool is_ineffective(const std::string &name) {
  for (const std::string &prefix : eigen_prefixes()) {
    if (!name.starts_with(prefix)) continue;
    const std::string rest = name.substr(prefix.size());
    if (starts_with_any(rest, {"largest", "smallest", "target", "interval", "all"})) return true;
    if (prefix != "infsup_eps_" && starts_with_any(rest, {"nev", "nsv", "ncv", "mpd"})) return true;
  }
  return false;
}

/// Why a run makes no supremizers; "" where it does.
std::string without_supremizers(const OfflineOptions &options) {
  if (!is_of(use::multipliers, options))
    return "Nitsche's method has no multipliers to make supremizers for";
  if (options.reduce.enrichment == Enrichment::decorrelated)
    return "-pga_enrichment decorrelated makes no supremizers";
  if (!is_of(use::dual_basis, options))
    return "-multiplier_reduction cone and collocated alone make supremizers";
  return "";
}

/// Why a run computes no inf-sup constants; "" where it does.
std::string without_constants(const OfflineOptions &options) {
  if (!is_of(use::dual_basis, options))
    return "inf-sup constants are of a reduced pair: -multiplier_reduction cone or collocated";
  return "";
}

std::string why_not(const std::string &name, const OfflineOptions &options, EigenUse use) {
  const bool of_greedy = name.starts_with("pga_");
  if (of_greedy && use != EigenUse::supremizers) return "supremizers are made by offline";
  const bool of_tolerance = use == EigenUse::supremizers && options.reduce.infsup_tolerance &&
                            options.reduce.enrichment == Enrichment::offline;
  if (!of_greedy && use == EigenUse::no_constants)
    return "-verify_stability no computes no inf-sup constants";
  if (!of_greedy && !of_tolerance && use != EigenUse::constants)
    return "inf-sup constants are computed by verify and, with -pga_tolerance infsup, by offline";
  return of_greedy || of_tolerance ? without_supremizers(options) : without_constants(options);
}

} // namespace

const std::vector<std::string> &eigen_prefixes() {
  static const std::vector<std::string> prefixes = prefixes_of({"eps_", "svd_"});
  return prefixes;
}

void check_eigen_options(const OfflineOptions &options, EigenUse use) {
  std::set<std::string> asked; // prefixes
  const std::vector<std::string> names = unread_names(eigen_prefixes());
  for (const std::string &name : names) {
    if (is_ineffective(name))
      throw bad_input(
          "-" + name +
          " has no effect: all values of a small matrix are computed, the smallest of a large one");
    const std::string reason = why_not(name, options, use);
    if (reason.empty())
      asked.insert(name.starts_with("pga_") ? "pga_" : "infsup_");
    else if (contains(options.command_line, name))
      throw bad_input("nothing of this run asks for the option -" + name + ": " + reason);
  }
  std::string unknown;
  for (const std::string &prefix : asked) {
    try {
      (void)make_small_svd(prefix.c_str());
      if (prefix == "pga_")
        (void)SmallEigen(prefix.c_str());
      else
        (void)make_infsup_eps(PETSC_COMM_SELF, 64);
    } catch (const Error &error) {
      throw bad_input("the options -" + prefix + "* do not work (" + error.what() + ")");
    }
    for (const std::string &name : unread_names(eigen_prefixes()))
      if (name.starts_with(prefix)) unknown += " -" + name;
  }
  if (!unknown.empty()) throw bad_input("nothing of this run asks for the option" + unknown);
  for (const std::string &name : names) // read by objects that solve nothing
    mark_unread(name);
}

void warn_of_eigen_options(MPI_Comm comm, const OfflineOptions &options) {
  std::vector<std::string> names;
  for (const std::string &name : options.command_line)
    if (starts_with_any(name, eigen_prefixes())) names.push_back(name);
  const std::vector<std::string> unread = unread_names(eigen_prefixes());
  std::vector<int> ignored;
  for (const std::string &name : names)
    ignored.push_back(contains(unread, name) ? 1 : 0);
  over_ranks(comm, MPI_MIN, ignored);
  for (std::size_t i = 0; i < names.size() && rank_of(comm) == 0; ++i)
    if (ignored[i] != 0)
      std::printf("warning: -%s has no effect here: no such object was needed\n", names[i].c_str());
}

} // namespace rbvi
