// rbvi run: check, offline, verify and figures of a case, one behind the other.
#include "geo_mesh.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/io/system_error.hpp"
#include "rbvi/io/write_atomically.hpp"
#include "rbvi/model/model.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/par/progress.hpp"
#include "rbvi/tool/commands.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <functional>

namespace rbvi {

namespace {

namespace fs = std::filesystem;

/// What the process prints goes into a file meanwhile, but for progress on a terminal, behind
/// `before`.
class IntoFile {
public:
  IntoFile(const fs::path &file, const std::string &before)
      : printed_(::fdopen(::dup(STDOUT_FILENO), "w")) {
    std::fflush(stdout);
    const int log = ::open(file.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0666);
    if (log < 0 || printed_ == nullptr || ::dup2(log, STDOUT_FILENO) < 0)
      throw cannot_write(file.string());
    ::close(log);
    show_progress_on(printed_, before);
  }
  ~IntoFile() {
    std::fflush(stdout);
    show_progress_on(stdout, "");
    ::dup2(::fileno(printed_), STDOUT_FILENO);
    std::fclose(printed_);
  }
  IntoFile(const IntoFile &) = delete;
  IntoFile &operator=(const IntoFile &) = delete;

private:
  std::FILE *printed_;
};

/// A line of the first rank for a step, whose own lines go into the log. Collective.
void take_step(const char *name, const fs::path &log, const std::function<void()> &work) {
  const bool first = rank_of(PETSC_COMM_WORLD) == 0;
  const double start = MPI_Wtime();
  constexpr std::size_t width = 10;
  std::string before = name;
  before.resize(width, ' ');
  if (first) std::printf("%s", before.c_str());
  if (first) std::fflush(stdout);
  try {
    std::optional<IntoFile> quiet;
    collectively(PETSC_COMM_WORLD, [&] {
      if (first) quiet.emplace(log, before);
    });
    work();
  } catch (const std::exception &) {
    if (first) std::printf("failed\n");
    throw;
  }
  if (first) std::printf("%8.1f s\n", MPI_Wtime() - start);
}

/// Draws by the program that is installed beside this one, or that of the sources around it. Throws
/// failure where there is none, or it cannot draw all. By one rank.
void draw(const fs::path &out) {
  std::error_code none;
  const fs::path folder = fs::read_symlink("/proc/self/exe", none).parent_path(),
                 installed = folder / "rbvi-figures", script = folder / "../../cases/figures.py";
  if (!fs::exists(installed, none) && !fs::exists(script, none))
    throw failure("there is no rbvi-figures beside this program: the model is there, and verified");
  const std::string program = fs::exists(installed, none)
                                  ? in_shell_quotes(installed.string())
                                  : "/usr/bin/python3 " + in_shell_quotes(script.string());
  if (std::system((program + " " + in_shell_quotes(out.string()) + " 2>&1").c_str()) != 0)
    throw failure("some figures of " + out.string() +
                  " cannot be drawn: " + (out / "run.log").string() + " says why");
}

void print_result(const ReducedModel &model) {
  const ValidationErrors &errors = expected_errors(model);
  std::printf("%d functions of u, %d of the multipliers; largest errors %.1e of u, %.1e of the "
              "multipliers\n",
              model.primal_size(), model.contact.generators, errors.u_max,
              std::max(errors.lambda_max, errors.tangential_max));
}

} // namespace

void command_run(ToolOptions options) {
  const MPI_Comm world = PETSC_COMM_WORLD;
  const fs::path log = options.out / "run.log";
  options.command_line.clear(); // read and checked: what is of one step serves the others not
  const auto by_first = [&](const std::function<void()> &work) {
    collectively(world, [&] {
      if (rank_of(world) == 0) work();
    });
  };
  const fs::path of_check =
      fs::temp_directory_path() / ("rbvi_check_" + std::to_string(::getpid()));
  by_first([&] { std::printf("%s\n", ("what each step prints goes to " + log.string()).c_str()); });
  try {
    take_step("check", of_check, [&] { command_check(options, options); });
  } catch (const Error &) { // a case that is wrong leaves nothing
    std::error_code none;
    fs::remove(of_check, none);
    throw;
  }
  by_first([&] {
    make_directory(options.out);
    fs::copy_file(of_check, log, fs::copy_options::overwrite_existing);
    fs::remove(of_check);
  });
  take_step("offline", log, [&] { command_offline(options); });
  take_step("verify", log, [&] { command_verify(options); });
  take_step("figures", log, [&] { by_first([&] { draw(options.out); }); });
  by_first([&] { print_result(read_model(options.out / "model.h5", *options.registry, false)); });
}

} // namespace rbvi
