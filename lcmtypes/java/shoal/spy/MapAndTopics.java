// SPDX-License-Identifier: BSD-3-Clause
package shoal.spy;

import java.awt.BorderLayout;
import java.awt.Dimension;
import java.awt.Graphics;
import java.awt.Graphics2D;
import java.awt.event.ActionEvent;
import java.io.IOException;
import java.util.HashMap;
import java.util.List;
import java.util.Map;
import java.util.TreeMap;
import java.util.regex.Matcher;
import java.util.regex.Pattern;
import javax.swing.AbstractAction;
import javax.swing.Action;
import javax.swing.JDesktopPane;
import javax.swing.JInternalFrame;
import javax.swing.JPanel;
import javax.swing.JScrollPane;
import javax.swing.JSplitPane;
import javax.swing.SwingUtilities;
import javax.swing.Timer;
import javax.swing.WindowConstants;
import lcm.lcm.LCM;
import lcm.lcm.LCMDataInputStream;
import lcm.lcm.LCMSubscriber;
import lcm.spy.ChannelData;
import lcm.spy.SpyPlugin;

/**
 * lcm-spy's window of a robot: its own map and its descriptors, from all that was said since the spy began. Opens with
 * a double click on SHOAL_<ROBOT>_BRICK, _CERTAINTY or _TOPICS. Listens itself, as the spy keeps only the last message.
 */
public final class MapAndTopics implements SpyPlugin {
  private static final Pattern CHANNEL = Pattern.compile("SHOAL_R([0-9]{1,4})_[A-Z]+");
  private final Team team = new Team();

  public MapAndTopics() {
    String url = System.getProperty("shoal.spy.url", "");
    try {
      LCM lcm = url.isEmpty() ? new LCM() : new LCM(url);
      lcm.subscribe("SHOAL_.*_(BRICK|CERTAINTY|TOPICS|REPAIR)", new LCMSubscriber() {
        @Override
        public void messageReceived(LCM from, String channel, LCMDataInputStream in) {
          hear(in);
        }
      });
    } catch (IOException error) {
      System.err.println("shoal-spy: maps stay empty: " + error.getMessage());
    }
  }

  private void hear(LCMDataInputStream in) {
    try {
      byte[] message = new byte[Math.min(in.available(), 2048)];
      in.readFully(message);
      team.hear(message);
    } catch (IOException ended) {
      // no whole message: nothing to show
    }
  }

  @Override
  public boolean canHandle(long fingerprint) {
    return fingerprint != shoal.repair_t.LCM_FINGERPRINT && Piece.canRead(fingerprint);
  }

  @Override
  public Action getAction(final JDesktopPane pane, final ChannelData channel) {
    return new AbstractAction("Map and topics") {
      @Override
      public void actionPerformed(ActionEvent event) {
        Matcher name = CHANNEL.matcher(channel.name);
        if (name.matches()) open(pane, Integer.parseInt(name.group(1)));
      }
    };
  }

  private void open(JDesktopPane pane, final int robot) {
    final Window window = new Window(team, robot);
    JInternalFrame frame = new JInternalFrame(String.format("R%02d: its own map and topics", robot), true, true, true, true);
    frame.setDefaultCloseOperation(WindowConstants.DISPOSE_ON_CLOSE);
    frame.setLayout(new BorderLayout());
    frame.add(window, BorderLayout.CENTER);
    java.awt.Window around = SwingUtilities.getWindowAncestor(pane);  // begins small
    if (around != null && around.getWidth() < 1120) around.setSize(1120, 700);
    frame.setBounds(0, 0, 1090, 620);
    final Timer timer = new Timer(1000, e -> window.look());
    frame.addInternalFrameListener(new javax.swing.event.InternalFrameAdapter() {
      @Override
      public void internalFrameClosed(javax.swing.event.InternalFrameEvent e) {
        timer.stop();
      }
    });
    pane.add(frame);
    frame.setVisible(true);
    frame.toFront();
    timer.start();
  }

  /** The map on the left, the descriptors on the right; looks again when something was heard. */
  private static final class Window extends JSplitPane {
    private final Team team;
    private final int robot;
    private final JPanel right;
    private long seen = -1;
    private Map<List<Integer>, long[]> cells = new HashMap<>();
    private TreeMap<Integer, Piece> topics = new TreeMap<>();

    Window(Team team, int robot) {
      super(JSplitPane.HORIZONTAL_SPLIT);
      this.team = team;
      this.robot = robot;
      JPanel left = new JPanel() {
        @Override
        protected void paintComponent(Graphics g) {
          Drawing.map((Graphics2D) g, cells, getWidth(), getHeight());
        }
      };
      right = new JPanel() {
        @Override
        protected void paintComponent(Graphics g) {
          super.paintComponent(g);
          Drawing.descriptors((Graphics2D) g, topics, getWidth());
        }
      };
      setLeftComponent(left);
      setRightComponent(new JScrollPane(right));
      setDividerLocation(500);
      look();
    }

    void look() {
      long now = team.changes();
      if (now == seen) return;
      seen = now;
      cells = team.cells(robot);
      topics = team.topics(robot);
      right.setPreferredSize(new Dimension(420, Drawing.heightOf(topics.size())));
      right.revalidate();
      repaint();
    }
  }
}
