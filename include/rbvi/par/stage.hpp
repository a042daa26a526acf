// One stage of the pipeline: timed, and a stage of PETSc's -log_view.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace rbvi {

/// Wall seconds of each stage, in order.
using StageTimes = std::vector<std::pair<std::string, double>>;

/// Measures from construction to destruction.
class Stage {
public:
  Stage(std::string name, StageTimes &times);
  ~Stage();
  Stage(const Stage &) = delete;
  Stage &operator=(const Stage &) = delete;

private:
  std::string name_;
  StageTimes &times_;
  double start_;
};

} // namespace rbvi
