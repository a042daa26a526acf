#include "rbvi/tool/finish.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/io/system_error.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/tool/options.hpp"
#include "table.hpp"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <fstream>

namespace rbvi {

namespace {

/// The lowest rank that failed (the number of ranks if none did), or nothing if some rank does not
/// arrive within a few seconds of a failure here.
std::optional<int> first_failure(MPI_Comm world, bool failed) {
  const int rank = rank_of(world), ranks = ranks_of(world);
  const int mine = failed ? rank : ranks;
  int first = ranks, done = 0;
  MPI_Request request = MPI_REQUEST_NULL;
  MPI_Iallreduce(&mine, &first, 1, MPI_INT, MPI_MIN, world, &request);
  const double start = MPI_Wtime();
  while (done == 0 && (!failed || MPI_Wtime() - start < 3))
    MPI_Test(&request, &done, MPI_STATUS_IGNORE);
  return done != 0 ? std::optional<int>(first) : std::nullopt;
}

Invocation refused(const std::string &reason) {
  Invocation result;
  result.status = static_cast<int>(Status::bad_input);
  result.message = "rbvi: " + reason;
  return result;
}

/// The first option that stands there twice; "": none does.
std::string given_twice(const std::vector<std::string> &words) {
  for (std::size_t i = 1; i < words.size(); ++i)
    if (is_option(words[i]) && std::find(words.begin(), words.begin() + static_cast<long>(i),
                                         words[i]) != words.begin() + static_cast<long>(i))
      return words[i];
  return "";
}

std::string left_over(const std::string &word) {
  return "'" + word + "' is left over: rbvi COMMAND -option value ... (rbvi -help)";
}

/// Takes the words behind compare. Returns why not.
std::string take_runs(Invocation &result, std::vector<std::string> &given) {
  for (std::size_t i = 1; i < given.size(); ++i)
    if (given[i] == "-csv" && i + 1 < given.size())
      result.topic = given[++i];
    else if (is_option(given[i]))
      return left_over(given[i]);
    else
      result.files.push_back(given[i]);
  if (result.files.size() < 2)
    return "compare takes run folders or model files: rbvi compare run/one run/other [-csv FILE]";
  given.resize(1);
  return "";
}

/// Takes the word behind the command, where it has one: a file, a folder, a name. Returns why not.
std::string take_word(Invocation &result, std::vector<std::string> &given) {
  const std::string &command = result.command;
  if (command == "compare") return take_runs(result, given);
  const bool word = given.size() > 1 && !is_option(given[1]);
  if ((command == "check" || command == "run") && word) given.insert(given.begin() + 1, "-case");
  if (command == "new" && given.size() == 4 && given[2] == "-mesh") {
    result.topic = given[3];
    given.resize(2);
  }
  if (command == "new" && (given.size() != 2 || !word))
    return "new takes the name of a folder: rbvi new my_case [-mesh FILE]";
  if (command == "inspect" && given.size() != 2)
    return "inspect takes one model file: rbvi inspect run/obstacle/model.h5";
  if (command == "list" && !word && given.size() == 1) given.emplace_back("cases");
  const bool takes = command == "inspect" || command == "list" || command == "new";
  if (command == "help" && given.size() > 1) return left_over(given[1]);
  if (!takes) return "";
  if (given.size() > 2 || is_option(given[1])) return left_over(given.back());
  result.file = given[1];
  given.resize(1);
  return "";
}

} // namespace

std::vector<char *> Invocation::pointers() const {
  std::vector<char *> result;
  for (std::string &argument : arguments)
    result.push_back(argument.data());
  result.push_back(nullptr);
  return result;
}

Invocation read_invocation(int argc, char **argv) {
  std::vector<std::string> names{"help"};
  for (const Command &command : commands())
    names.push_back(command.name);
  Invocation result;
  std::vector<std::string> given = normalised_arguments(argc, argv);
  const auto has = [&](const char *name) {
    return std::find(given.begin(), given.end(), name) != given.end();
  };
  if (has("-version")) {
    result.status = 0;
    result.message = "rbvi " RBVI_VERSION;
    return result;
  }
  const bool whole = has("-help") || has("-h");
  if (given.size() < 2 || whole) {
    for (const char *option : {"-scene", "-case"})
      if (const auto named = std::find(given.begin(), given.end(), option); given.end() - named > 1)
        result.file = *(named + 1);
    result.json = has("-json");
    if (given.size() > 1 && !is_option(given[1])) result.topic = given[1];
    given.resize(1);
    given.emplace_back("help");
  }
  result.command = given[1];
  if (result.command == "help" && !whole) result.topic = "help";
  if (std::find(names.begin(), names.end(), result.command) == names.end())
    return refused("unknown command '" + result.command + "'; the nearest one is '" +
                   nearest_name(result.command, names) + "' (rbvi -help lists all)");
  given.erase(given.begin() + 1);
  if (const std::string name = given_twice(given); !name.empty())
    return refused(name + " is given twice: keep one of the two");
  const bool takes_word = result.command == "inspect" || result.command == "list" ||
                          result.command == "check" || result.command == "new" ||
                          result.command == "run";
  const std::size_t words = takes_word ? 2 : 1;
  for (std::size_t i = words; result.command != "compare" && i < given.size(); ++i)
    if (!is_option(given[i]) && !is_option(given[i - 1])) return refused(left_over(given[i]));
  // PETSc reads these on one rank alone while the others wait.
  for (std::size_t i = 1; i < given.size(); ++i)
    if (given[i - 1].starts_with("-options_file") && !std::ifstream(given[i]))
      return refused("the options file " + given[i] + " cannot be read" + system_reason());
  if (const std::string reason = take_word(result, given); !reason.empty()) return refused(reason);
  result.arguments = given;
  return result;
}

int report_once(int status, const std::string &message) {
  MPI_Init(nullptr, nullptr);
  std::FILE *stream = status == 0 ? stdout : stderr;
  if (rank_of(MPI_COMM_WORLD) == 0) std::fprintf(stream, "%s\n", message.c_str());
  if (std::fflush(stream) != 0 || std::ferror(stream) != 0)
    status = static_cast<int>(Status::failed);
  MPI_Barrier(MPI_COMM_WORLD); // mpirun ends all at the first status that is not zero
  MPI_Finalize();
  return status;
}

int finish(MPI_Comm world, const std::function<void()> &work) {
  std::string message;
  int status = 0;
  const int rank = rank_of(world);
  try {
    work();
  } catch (const Error &error) {
    message = error.what();
    status = static_cast<int>(error.status());
  } catch (const std::exception &error) {
    message = error.what();
    status = static_cast<int>(Status::failed);
  }
  errno = 0; // where an earlier line was lost, its reason is, too
  if ((std::fflush(stdout) != 0 || std::ferror(stdout) != 0) && status == 0) {
    message = cannot_write("to standard output").what();
    status = static_cast<int>(Status::failed);
  }
  const std::optional<int> first = first_failure(world, status != 0);
  // Where several ranks fail and others hang, the lowest comes first and ends the rest.
  if (!first) usleep(static_cast<useconds_t>(std::min(rank, 20)) * 200000);
  if (status != 0 && first.value_or(rank) == rank)
    std::fprintf(stderr, "rbvi: %s\n", in_plain_words(message).c_str());
  if (!first) MPI_Abort(world, status);
  int worst = status;
  MPI_Allreduce(&status, &worst, 1, MPI_INT, MPI_MAX, world);
  return worst;
}

} // namespace rbvi
