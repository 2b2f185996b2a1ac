// SPDX-License-Identifier: BSD-3-Clause
import java.lang.reflect.Constructor;
import java.lang.reflect.Field;
import java.nio.file.Files;
import java.nio.file.Path;
import java.util.Map;
import lcm.lcm.LCMDataInputStream;
import lcm.spy.LCMTypeDatabase;

/** Decodes the golden messages the way lcm-spy does and compares fields with the values of examples.cc. */
public class DecodeGolden {
  static int failures = 0;

  static Object decode(LCMTypeDatabase types, Path file) throws Exception {
    byte[] bytes = Files.readAllBytes(file);
    long fingerprint = new LCMDataInputStream(bytes).readLong();
    Class<?> type = types.getClassByFingerprint(fingerprint);
    if (type == null) throw new Exception(file + ": the spy knows no type of this fingerprint");
    Constructor<?> constructor = type.getConstructor(java.io.DataInput.class);
    return constructor.newInstance(new LCMDataInputStream(bytes));
  }

  static void expect(Object message, Map<String, Object> fields) throws Exception {
    for (Map.Entry<String, Object> field : fields.entrySet()) {
      Field f = message.getClass().getField(field.getKey());
      Object value = f.get(message);
      if (!value.toString().equals(field.getValue().toString())) {
        System.err.println(message.getClass() + "." + f.getName() + " is " + value + ", not " + field.getValue());
        ++failures;
      }
    }
    System.out.println(message.getClass().getName() + " decoded");
  }

  public static void main(String[] arguments) throws Exception {
    LCMTypeDatabase types = new LCMTypeDatabase();
    Path folder = Path.of(arguments[0]);
    final int mission = 20210529;
    final long time = 61500000L;
    expect(decode(types, folder.resolve("heartbeat.bin")),
        Map.of("utime", 61000000L, "mission", mission, "observation", 60, "num_topics", 9, "x_m", 12.5f,
            "ms_per_frame", 17.75f, "state_digest", 0xfedcba9876543210L, "cell_size_m", 0.8, "budget", 2000));
    expect(decode(types, folder.resolve("topics.bin")),
        Map.of("utime", time, "mission", mission, "robot", 3, "topic", 12, "part", 1, "num_parts", 3, "epoch", 1,
            "observation", 60, "num_words", 6));
    expect(decode(types, folder.resolve("bricks.bin")),
        Map.of("utime", time, "mission", mission, "robot", 3, "epoch", 1, "bricks", 2));
    expect(decode(types, folder.resolve("certainties.bin")),
        Map.of("utime", time, "mission", mission, "robot", 3, "epoch", 1, "certain_bricks", 2));
    expect(decode(types, folder.resolve("matches.bin")),
        Map.of("utime", time, "mission", mission, "map_digest", 77L, "num_chunks", 1, "correspondences", 4));
    expect(decode(types, folder.resolve("labels.bin")),
        Map.of("utime", time, "mission", mission, "map_digest", 77L, "labels", 3));
    expect(decode(types, folder.resolve("map_1.bin")),
        Map.of("utime", time, "mission", mission, "map_digest", 77L, "chunk", 1, "num_chunks", 2, "brick_x", 0,
            "fused_cells", 6));
    System.exit(failures == 0 ? 0 : 1);
  }
}
