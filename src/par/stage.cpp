#include "rbvi/par/stage.hpp"

#include "rbvi/par/petsc.hpp"

namespace rbvi {

Stage::Stage(std::string name, StageTimes &times)
    : name_(std::move(name)), times_(times), start_(MPI_Wtime()) {
  PetscLogStage stage = -1;
  RBVI_CALL(PetscLogStageGetId(name_.c_str(), &stage));
  if (stage < 0) RBVI_CALL(PetscLogStageRegister(name_.c_str(), &stage));
  RBVI_CALL(PetscLogStagePush(stage));
}

Stage::~Stage() {
  (void)PetscLogStagePop();
  times_.emplace_back(name_, MPI_Wtime() - start_);
}

} // namespace rbvi
