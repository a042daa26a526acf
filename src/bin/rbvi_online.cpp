// rbvi-online: answers parameters from a reduced model, on one core.
#include "rbvi/io/system_error.hpp"
#include "rbvi/rom/online_tool.hpp"

#include <exception>
#include <iostream>

namespace {

void run(const std::vector<std::string> &arguments) {
  rbvi::run_online(rbvi::parse_online_arguments(arguments), std::cout);
  if (!std::cout.flush()) throw rbvi::cannot_write("to standard output");
}

} // namespace

int main(int count, char **arguments) {
  try {
    run({arguments + 1, arguments + count});
    return static_cast<int>(rbvi::Status::done);
  } catch (const rbvi::Error &error) {
    std::cerr << "rbvi-online: " << rbvi::in_plain_words(error.what()) << '\n';
    return static_cast<int>(error.status());
  } catch (const std::exception &error) {
    std::cerr << "rbvi-online: " << rbvi::in_plain_words(error.what()) << '\n';
    return static_cast<int>(rbvi::Status::failed);
  }
}
