// smooth_file FILE TOLERANCE_MM [TARGET [FORM]]   writes FILE smoothed for TARGET (linuxcnc) as
// FORM (auto, curves, arcs, lines) to standard output, and what became of it to standard error.
// Ends with 0 when the new program is proved.

#include <batten/batten.h>

#include <exception>
#include <fstream>
#include <iostream>
#include <iterator>
#include <string>

namespace {

int smooth_file(const std::string& file, double tolerance_mm, const std::string& target,
                const std::string& form) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) {
    std::cerr << file << ": cannot be read\n";
    return 1;
  }
  const std::string program{std::istreambuf_iterator<char>(stream), {}};

  batten::Options options;
  options.target = target;
  options.output = form;
  options.tolerance_mm = tolerance_mm;
  const batten::SmoothedProgram smoothed = batten::smooth(program, options);
  for (const batten::Message& message : smoothed.messages) {
    std::cerr << file << ":" << message.line << ": " << message.id << ": " << message.text << "\n";
  }
  if (!smoothed.understood || !smoothed.proved) return 1;

  // The proof can be asked for again, as for any two programs.
  const batten::Proof proof = batten::verify(program, smoothed.text, tolerance_mm,
                                             batten::ProgramUnits::kAsWritten, target);
  std::cerr << "batten " << batten::version() << ": " << smoothed.blocks_before << " -> "
            << smoothed.blocks_after << " blocks, " << smoothed.seconds_before << " -> "
            << smoothed.seconds_after << " s, at most " << proof.deviation_mm << " mm off\n";
  const batten::ProgramTime time =
      batten::time(smoothed.text, {.machine = "linuxcnc", .target = target});
  std::cerr << "the whole program: " << time.seconds << " s\n";
  std::cout << smoothed.text;
  return proof.proved ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3 || argc > 5) {
    std::cerr << "usage: smooth_file FILE TOLERANCE_MM [TARGET [FORM]]\n";
    return 2;
  }
  try {
    return smooth_file(argv[1], std::atof(argv[2]), argc > 3 ? argv[3] : "linuxcnc",
                       argc > 4 ? argv[4] : "auto");
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return 2;
  }
}
