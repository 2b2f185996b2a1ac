// SPDX-License-Identifier: BSD-3-Clause
// Against scikit-learn itself, where it is installed: labellings of every shape, drawn at random.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include "shoal/eval/ami.h"
#include "shoal/random.h"

namespace shoal::eval {
namespace {

TEST(AmiAgainstScikitLearnTest, AgreesOnRandomLabellings) {
  Random random(20210529);
  const std::string path = ::testing::TempDir() + "shoal_ami_labellings.txt";
  std::ofstream file(path);
  std::vector<Contingency> tables;
  for (int trial = 0; trial < 60; ++trial) {
    const size_t size = 2 + random.below(400);
    std::vector<int> label(size);
    std::vector<int> truth(size);
    const uint64_t num_labels = 1 + random.below(1 + size / 3);
    const uint64_t num_classes = 1 + random.below(12);
    const double agreement = random.uniform();
    for (size_t n = 0; n < size; ++n) {
      truth[n] = static_cast<int>(random.below(num_classes));
      label[n] = random.uniform() < agreement ? truth[n] : static_cast<int>(random.below(num_labels));
    }
    tables.push_back(contingency(label, truth));
    for (const int l : label) file << l << ' ';
    file << '\n';
    for (const int t : truth) file << t << ' ';
    file << '\n';
  }
  file.close();

  const std::string command = std::string(SHOAL_PYTHON) + " " + SHOAL_AMI_REFERENCE + " < " + path;
  std::FILE* pipe = popen(command.c_str(), "r");
  ASSERT_NE(pipe, nullptr);
  size_t read = 0;
  for (double expected_ami = 0, expected_nmi = 0;
       std::fscanf(pipe, "%lf %lf", &expected_ami, &expected_nmi) == 2;) {
    ASSERT_LT(read, tables.size());
    EXPECT_NEAR(ami(tables[read]), expected_ami, 1e-9) << "labelling " << read;
    EXPECT_NEAR(nmi(tables[read]), expected_nmi, 1e-9) << "labelling " << read;
    ++read;
  }
  EXPECT_EQ(pclose(pipe), 0);
  EXPECT_EQ(read, tables.size());
  std::remove(path.c_str());
}

}  // namespace
}  // namespace shoal::eval
