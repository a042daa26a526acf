#include "rbvi/par/stage_cost.hpp"

#include "rbvi/par/collective.hpp"
#include "rbvi/par/petsc.hpp"

#include <malloc.h>
#include <sys/resource.h>

#include <algorithm>
#include <fstream>
#include <initializer_list>
#include <string>

namespace rbvi {

namespace {

/// A line "VmHWM:   12345 kB" of /proc/self/status, in bytes; 0 where there is none.
double status_line(const std::string &name) {
  std::ifstream status("/proc/self/status");
  std::string word;
  while (status >> word)
    if (double kilobytes = 0; word == name && status >> kilobytes) return 1024 * kilobytes;
  return 0;
}

/// What peak_bytes() tells, where the system lets it be forgotten.
void forget_peak() {
  std::ofstream("/proc/self/clear_refs") << 5 << std::flush;
}

/// The peak of the innermost running meter before the last call of forget_peak().
double earlier_peak = 0;

double cpu_seconds() {
  rusage used{};
  (void)getrusage(RUSAGE_SELF, &used);
  const auto seconds = [](const timeval &time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(used.ru_utime) + seconds(used.ru_stime);
}

/// How often events of PETSc were, and for how long, in all of its stages together.
struct Events {
  double count = 0, seconds = 0;
};

Events all_of(std::initializer_list<const char *> names) {
  PetscStageLog log = nullptr;
  RBVI_CALL(PetscLogGetStageLog(&log));
  Events all;
  for (const char *name : names) {
    PetscLogEvent event = -1;
    RBVI_CALL(PetscLogEventGetId(name, &event));
    for (int stage = 0; event >= 0 && stage < log->numStages; ++stage) {
      const PetscEventPerfLog of_stage = log->stageInfo[stage].eventLog;
      if (event >= of_stage->numEvents) continue;
      all.count += of_stage->eventInfo[event].count;
      all.seconds += of_stage->eventInfo[event].time;
    }
  }
  return all;
}

/// What has been counted since the start of the process; memory left out.
StageCost counters() {
  StageCost now;
  now.seconds = MPI_Wtime();
  now.cpu = cpu_seconds();
  now.messages = (petsc_irecv_ct + petsc_isend_ct + petsc_recv_ct + petsc_send_ct) / 2;
  now.bytes = (petsc_irecv_len + petsc_isend_len + petsc_recv_len + petsc_send_len) / 2;
  now.reductions = petsc_allreduce_ct + petsc_gather_ct + petsc_scatter_ct;
  now.symbolic = all_of({"MatCholFctrSym", "MatLUFactorSym"}).count;
  const Events factors = all_of({"MatCholFctrNum", "MatLUFactorNum"});
  const Events solves = all_of({"MatSolve", "MatMatSolve"});
  now.factorisations = factors.count;
  now.factor_seconds = factors.seconds;
  now.solves = solves.count;
  now.solve_seconds = solves.seconds;
  now.assemblies = all_of({"MatSetValuesCOO"}).count;
  now.interpolations = all_of({"EIM"}).count;
  now.cg_steps = all_of({"VecTDot"}).count / 2; // PETSc's CG takes two in a step; nobody else does
  return now;
}

} // namespace

CountedEvent::CountedEvent(const char *name) {
  PetscLogEvent event = -1;
  RBVI_CALL(PetscLogEventGetId(name, &event));
  if (event < 0) RBVI_CALL(PetscLogEventRegister(name, PETSC_OBJECT_CLASSID, &event));
  RBVI_CALL(PetscLogEventBegin(event, nullptr, nullptr, nullptr, nullptr));
  event_ = event;
}

CountedEvent::~CountedEvent() {
  (void)PetscLogEventEnd(event_, nullptr, nullptr, nullptr, nullptr);
}

StageCost operator+(StageCost first, const StageCost &second) {
  const double memory = std::max(first.memory, second.memory);
  for (const auto member : StageCost::members())
    first.*member += second.*member;
  first.memory = memory;
  return first;
}

void measure_costs() {
  if (!costs_are_measured()) RBVI_CALL(PetscLogDefaultBegin());
}

bool costs_are_measured() {
  PetscBool active = PETSC_FALSE;
  RBVI_CALL(PetscLogIsActive(&active));
  return active == PETSC_TRUE;
}

CostMeter::CostMeter() {
  (void)malloc_trim(0);
  const double before = std::max(earlier_peak, peak_bytes());
  forget_peak();
  earlier_peak = 0;
  start_ = counters();
  start_.memory = before;
}

CostMeter::~CostMeter() {
  earlier_peak = std::max({start_.memory, earlier_peak});
}

StageCost CostMeter::so_far() const {
  StageCost cost = counters();
  for (const auto member : StageCost::members())
    cost.*member -= start_.*member;
  cost.memory = std::max(earlier_peak, peak_bytes());
  return cost;
}

double peak_bytes() {
  return status_line("VmHWM:");
}

double resident_bytes() {
  (void)malloc_trim(0);
  return status_line("VmRSS:");
}

RankCosts costs_over_ranks(MPI_Comm comm, const StageCost &cost) {
  std::array<double, StageCost::members().size()> largest{}, sum{};
  for (std::size_t i = 0; i < largest.size(); ++i)
    largest[i] = sum[i] = cost.*StageCost::members()[i];
  over_ranks(comm, MPI_MAX, largest);
  over_ranks(comm, MPI_SUM, sum);
  RankCosts costs;
  for (std::size_t i = 0; i < largest.size(); ++i) {
    costs.largest.*StageCost::members()[i] = largest[i];
    costs.sum.*StageCost::members()[i] = sum[i];
  }
  return costs;
}

} // namespace rbvi
