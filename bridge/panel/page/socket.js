// The one connection to the panel's server: what it tells goes to `heard`, what is asked comes back as a promise.
const AGAIN = 1000; // [ms] until the next attempt

export function connect(heard, changed) {
  let socket = null;
  let next = 1;
  const waiting = new Map();

  function open() {
    const scheme = location.protocol === "https:" ? "wss" : "ws";
    socket = new WebSocket(`${scheme}://${location.host}/socket`);
    socket.onopen = () => { changed(true); rest(); };
    socket.onclose = () => {
      changed(false);
      for (const done of waiting.values()) done({ refused: "the connection to the panel was lost" });
      waiting.clear();
      setTimeout(open, AGAIN);
    };
    socket.onmessage = (message) => take(JSON.parse(message.data));
  }

  function take(told) {
    if (told.type !== "answer") return heard(told);
    waiting.get(told.id)?.(told);
    waiting.delete(told.id);
  }

  // Ask for something: `done` or `refused` of the answer.
  function ask(what, more = {}) {
    if (socket?.readyState !== WebSocket.OPEN) return Promise.resolve({ refused: "there is no connection to the panel" });
    const id = next++;
    socket.send(JSON.stringify({ id, do: what, ...more }));
    return new Promise((done) => waiting.set(id, done));
  }

  const rest = () => ask("rest", { resting: document.hidden });
  document.addEventListener("visibilitychange", rest);
  open();
  return ask;
}
