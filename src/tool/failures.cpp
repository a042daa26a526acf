#include "failures.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/par/collective.hpp"

#include <cstdio>

namespace rbvi {

namespace {

/// "74 of 125 training samples failed"
std::string count_of(const SweepReport &report, std::size_t total, const std::string &set) {
  return std::to_string(report.failed.size()) + " of " + std::to_string(total) + " " + set +
         " samples failed";
}

} // namespace

void check_failures(const ParameterSpace &space, double most, const SweepReport &report,
                    std::size_t total, const std::string &set) {
  if (rank_of(PETSC_COMM_WORLD) == 0)
    for (const auto &[mu, reason] : report.failed)
      std::printf("  failed at %s: %s\n", describe(space, mu).c_str(), reason.c_str());
  const auto failed = static_cast<double>(report.failed.size());
  if (!report.failed.empty() && report.failed.size() == total)
    throw failure("no sample succeeded, the first because " + report.failed.front().second);
  if (failed > most * static_cast<double>(total) + 1e-9)
    throw failure(count_of(report, total, set) + ", more than -sweep_max_failures " +
                  short_number(most) +
                  " allows: nothing is made of the others; see the reasons above, and change the "
                  "box or the options of the solver");
}

void report_failures(const ParameterSpace &space, const SweepReport &report, std::size_t total,
                     const std::string &set, const std::string &consequence) {
  if (report.failed.empty()) return;
  const Mu &mu = report.failed.front().first;
  throw failure(count_of(report, total, set) + " (the first at " + describe(space, mu) +
                "): " + consequence);
}

} // namespace rbvi
