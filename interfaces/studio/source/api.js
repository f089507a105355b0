// Requests to the server: the token stands in the fragment of the address.

const token = () => location.hash.slice(1);
const headers = (more = {}) => ({ Authorization: `Bearer ${token()}`, ...more });

/** An answer that says no. */
export class Refusal extends Error {
  constructor(status, content) {
    super(content.error ?? `the server answers ${status}`);
    this.status = status;
    this.content = content;
  }
}

async function answered(response) {
  const content = await response.json().catch(() => ({}));
  if (!response.ok) throw new Refusal(response.status, content);
  return content;
}

export const get = async (name) => answered(await fetch(`/studio/${name}`, { headers: headers() }));

export const post = async (name, body = {}) => answered(await fetch(`/studio/${name}`, {
  method: "POST", headers: headers({ "Content-Type": "application/json" }), body: JSON.stringify(body),
}));

/** Put a file into the folder; the name that it has there. */
export const send = async (file) => answered(await fetch(`/studio/receive?name=${encodeURIComponent(file.name)}`, {
  method: "POST", headers: headers({ "Content-Type": "application/octet-stream" }), body: file,
}));

/** The bytes of a picture; the browser keeps them by their digest. */
export async function blob(digest) {
  const response = await fetch(`/studio/blob/${digest}`, { headers: headers() });
  if (!response.ok) throw new Refusal(response.status, await response.json().catch(() => ({})));
  return new Uint8Array(await response.arrayBuffer());
}

/** Events as long as the page is open: lines that are lost are taken up again. */
export async function listen(hear, onState) {
  for (let wait = 500; ; wait = Math.min(8000, 2 * wait)) {
    try {
      const response = await fetch("/studio/events", { headers: headers() });
      if (!response.ok) throw new Refusal(response.status, await response.json().catch(() => ({})));
      onState(true);
      wait = 500;
      await readLines(response.body.pipeThrough(new TextDecoderStream()).getReader(), hear);
    } catch (error) {
      if (error.status === 401) { onState(false, error.message); return; }
    }
    onState(false);
    await new Promise((done) => setTimeout(done, wait));
  }
}

async function readLines(reader, hear) {
  let rest = "";
  for (;;) {
    const { value, done } = await reader.read();
    if (done) return;
    const parts = (rest + value).split("\n\n");
    rest = parts.pop();
    for (const part of parts) if (part.startsWith("data: ")) hear(JSON.parse(part.slice(6)));
  }
}
