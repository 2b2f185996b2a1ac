// SPDX-License-Identifier: BSD-3-Clause
import java.awt.Graphics2D;
import java.awt.image.BufferedImage;
import java.io.EOFException;
import java.io.File;
import java.io.PrintWriter;
import java.nio.file.Files;
import java.nio.file.Path;
import java.util.List;
import java.util.Map;
import java.util.Random;
import javax.imageio.ImageIO;
import lcm.logging.Log;
import shoal.spy.BadMessage;
import shoal.spy.Drawing;
import shoal.spy.Piece;
import shoal.spy.Team;

/**
 * SpyMapTest LOG OUT GOLDEN...: what the spy's window makes of a recording, as OUT/spy_map.txt and a picture a robot;
 * then damaged golden messages, each of which is refused or read. SpyMapTest --refused MESSAGE: why it is.
 */
public class SpyMapTest {
  public static void main(String[] arguments) throws Exception {
    if (arguments[0].equals("--refused")) {
      try {
        System.out.println("read: " + Piece.read(Files.readAllBytes(Path.of(arguments[1]))).size() + " pieces");
      } catch (BadMessage bad) {
        System.out.println("refused: " + bad.getMessage());
      }
      return;
    }
    Team team = new Team();
    Log log = new Log(arguments[0], "r");
    try {
      while (true) {
        Log.Event event = log.readNext();
        if (event.channel.matches("SHOAL_.*_(BRICK|CERTAINTY|TOPICS|REPAIR)")) team.hear(event.data);
      }
    } catch (EOFException end) {
      write(team, arguments[1]);
    }
    int read = 0, refused = 0;
    Random random = new Random(8);
    for (int file = 2; file < arguments.length; ++file) {
      byte[] golden = Files.readAllBytes(Path.of(arguments[file]));
      for (Piece piece : Piece.read(golden)) {
        if (piece.kind != Piece.Kind.TOPIC) continue;
        System.out.println("golden " + piece.robot + " " + piece.epoch + " " + piece.observation + " " + piece.part + " " +
                           piece.numParts + " " + piece.index + " " + piece.weight + " " +
                           java.util.Arrays.toString(piece.groups) + " " + piece.words);
      }
      for (int repeat = 0; repeat < 1500; ++repeat) {
        byte[] damaged = damage(golden, random, repeat);
        try {
          Piece.read(damaged);
          ++read;
        } catch (BadMessage bad) {
          ++refused;
        }
        team.hear(damaged);
      }
    }
    write(team, null);  // whatever got in can be drawn
    System.out.println("damaged messages: " + read + " read, " + refused + " refused");
  }

  private static byte[] damage(byte[] golden, Random random, int repeat) {
    byte[] bytes = golden.clone();
    if (repeat % 10 == 0) return java.util.Arrays.copyOf(bytes, random.nextInt(bytes.length));
    for (int i = random.nextInt(4); i >= 0; --i) bytes[8 + random.nextInt(bytes.length - 8)] ^= 1 << random.nextInt(8);
    if (repeat % 10 == 1) return bytes;
    bytes[20] = 3;
    // With a checksum that fits: what comes behind it meets the damage too.
    for (int head : new int[] {35, 45, 28}) {
      int n = java.nio.ByteBuffer.wrap(golden).getInt(head - 4);
      if (n != golden.length - head) continue;
      java.nio.ByteBuffer.wrap(bytes).putInt(head - 4, n).putShort(head - 6, (short) 0);
      int crc = 0xFFFF;
      for (byte b : bytes) {
        crc ^= (b & 255) << 8;
        for (int bit = 0; bit < 8; ++bit) crc = (crc << 1 ^ ((crc & 0x8000) != 0 ? 0x1021 : 0)) & 0xFFFF;
      }
      java.nio.ByteBuffer.wrap(bytes).putShort(head - 6, (short) crc);
    }
    return bytes;
  }

  private static void write(Team team, String folder) throws Exception {
    PrintWriter text = folder == null ? null : new PrintWriter(new File(folder, "spy_map.txt"));
    for (int robot : team.robots()) {
      Map<List<Integer>, long[]> cells = team.cells(robot);
      Map<Integer, Piece> topics = team.topics(robot);
      BufferedImage image = new BufferedImage(1100, Math.max(520, Drawing.heightOf(topics.size())), BufferedImage.TYPE_INT_RGB);
      Graphics2D g = image.createGraphics();
      Drawing.map(g, cells, 520, 520);
      g.translate(530, 0);
      Drawing.descriptors(g, team.topics(robot), 570);
      g.dispose();
      if (folder == null) continue;
      ImageIO.write(image, "png", new File(folder, String.format("spy_R%02d.png", robot)));
      for (Map.Entry<List<Integer>, long[]> cell : cells.entrySet())
        text.println(robot + " cell " + cell.getKey() + " " + java.util.Arrays.toString(cell.getValue()) + " #" +
                     Integer.toHexString(Drawing.colorOf(cell.getValue()[0]).getRGB()).substring(2));
      for (Map.Entry<Integer, Piece> topic : topics.entrySet())
        text.println(robot + " topic " + topic.getKey() + " " + topic.getValue().weight + " " +
                     java.util.Arrays.toString(topic.getValue().groups) + " " + topic.getValue().words);
    }
    if (text != null) text.close();
  }
}
